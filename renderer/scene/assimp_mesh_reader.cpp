// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/assimp_mesh_reader.hpp"

#include <stdexcept>

#ifndef SONARD_HAS_ASSIMP

namespace sonard::render {

RawMesh read_with_assimp(const std::filesystem::path&, const std::string&) {
  throw std::runtime_error(
      "this program was built without Assimp, which reads this format: install libassimp-dev and build "
      "again, "
      "or export the mesh as OBJ, STL, PLY or DAE");
}

}  // namespace sonard::render

#else

#include <array>
#include <cstddef>
#include <system_error>

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include "renderer/scene/local_file.hpp"

namespace sonard::render {
namespace {

/// Lets Assimp open files in one folder and below: a .gltf may name any file as its buffer.
class OneFolderOnly : public Assimp::DefaultIOSystem {
 public:
  explicit OneFolderOnly(const std::filesystem::path& folder)
      : folder_(std::filesystem::weakly_canonical(folder)) {}

  bool Exists(const char* name) const override { return is_inside(name) && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return is_inside(name) ? DefaultIOSystem::Open(name, mode) : nullptr;
  }

 private:
  bool is_inside(const char* name) const {
    std::error_code error;
    const std::filesystem::path path =
        std::filesystem::weakly_canonical(name, error).lexically_relative(folder_);
    return !error && !path.empty() && *path.begin() != "..";
  }

  std::filesystem::path folder_;
};

glm::dmat4 matrix_of(const aiMatrix4x4& m) {
  glm::dmat4 matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      matrix[column][row] = static_cast<double>(m[static_cast<unsigned int>(row)][column]);
    }
  }
  return matrix;
}

/// Metres of an FBX with z up, from its own unit and axes. Without a word of them: centimetres and y up, the
/// defaults of the format.
glm::dmat4 fbx_axes(const aiScene& scene) {
  const auto setting = [&](const char* name, auto value) {
    if (scene.mMetaData != nullptr) {
      scene.mMetaData->Get(name, value);
    }
    return value;
  };
  const int up = setting("UpAxis", std::int32_t{1});
  const int front = setting("FrontAxis", std::int32_t{2});
  const int right = setting("CoordAxis", std::int32_t{0});
  if ((1 << up | 1 << front | 1 << right) != 0b111) {
    throw std::runtime_error("UpAxis, FrontAxis and CoordAxis are to be three different axes, 0 to 2");
  }
  const double unit_m = 0.01 * static_cast<double>(setting("UnitScaleFactor", 1.0F));
  glm::dmat4 matrix(0.0);
  matrix[right][0] = unit_m * setting("CoordAxisSign", std::int32_t{1});
  matrix[front][1] = -unit_m * setting("FrontAxisSign", std::int32_t{1});
  matrix[up][2] = unit_m * setting("UpAxisSign", std::int32_t{1});
  matrix[3][3] = 1.0;
  return matrix;
}

RawPart triangles_of(const aiScene& scene, const aiMesh& mesh) {
  RawPart part;
  part.material_name = scene.mMaterials[mesh.mMaterialIndex]->GetName().C_Str();
  if (part.material_name == AI_DEFAULT_MATERIAL_NAME) {
    part.material_name.clear();
  }
  for (unsigned int i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& p = mesh.mVertices[i];
    part.positions.emplace_back(p.x, p.y, p.z);
    if (mesh.HasNormals()) {
      part.normals.emplace_back(mesh.mNormals[i].x, mesh.mNormals[i].y, mesh.mNormals[i].z);
    }
    if (mesh.HasTextureCoords(0)) {
      part.texcoords.emplace_back(mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y);
    }
  }
  for (unsigned int i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices == 3) {
      part.indices.insert(part.indices.end(), face.mIndices, face.mIndices + 3);
    }
  }
  return part;
}

class Collector {
 public:
  Collector(const aiScene& scene, const std::string& submesh) : scene_(scene), submesh_(submesh) {}

  void add(const aiNode& node, const glm::dmat4& T_mesh_node, bool selected) {
    selected = is_wanted(node.mName) || selected;
    for (unsigned int i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
      if (is_wanted(mesh.mName) || selected) {
        mesh_.add(triangles_of(scene_, mesh), T_mesh_node);
      }
    }
    for (unsigned int i = 0; i < node.mNumChildren; ++i) {
      const aiNode& child = *node.mChildren[i];
      add(child, T_mesh_node * matrix_of(child.mTransformation), selected);
    }
  }

  RawMesh take() { return std::move(mesh_); }

 private:
  bool is_wanted(const aiString& name) {
    if (name.length > 0) {
      mesh_.names.emplace_back(name.C_Str());
    }
    return submesh_ == name.C_Str();
  }

  const aiScene& scene_;
  const std::string& submesh_;
  RawMesh mesh_;
};

}  // namespace

RawMesh read_with_assimp(const std::filesystem::path& file, const std::string& submesh) {
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFolderOnly(file.parent_path()));  // the importer owns it
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_TEXTURES, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw std::runtime_error(importer.GetErrorString());
  }
  Collector collector(*scene, submesh);
  const aiNode& root = *scene->mRootNode;
  // The root of an FBX is Assimp's own; releases differ in what of unit and axes they put into it.
  const bool is_fbx = lower_extension(file) == "fbx";
  collector.add(root, is_fbx ? fbx_axes(*scene) : matrix_of(root.mTransformation), submesh.empty());
  return collector.take();
}

}  // namespace sonard::render

#endif
