// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/assimp_mesh_reader.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <assimp/ColladaMetaData.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <fmt/format.h>

#include "common/text/percent_decoding.hpp"
#include "renderer/scene/collada_for_assimp.hpp"
#include "renderer/scene/local_file.hpp"
#include "renderer/scene/obj_for_assimp.hpp"

namespace sonard::render {
namespace {

/// Lets Assimp open only regular files below the folders of the world. Keeps a message about the first other
/// file that a mesh names.
class WorldFiles : public Assimp::IOSystem {
 public:
  /// @param text in place of the file, if it names no others
  WorldFiles(const MeshSource& source, const std::optional<std::string>& text, std::string& refusal)
      : folder_(source.file.parent_path() / ""), folders_(source.folders), text_(text), refusal_(refusal) {
    folders_.push_back(std::filesystem::weakly_canonical(folder_));
  }

  bool Exists(const char* name) const override { return !permitted(name).empty(); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    const std::filesystem::path path = permitted(name);
    if (path.empty()) {
      return nullptr;
    }
    if (text_) {
      return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text_->data()), text_->size());
    }
    return disk_.Open(path.c_str(), mode);
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  char getOsSeparator() const override { return disk_.getOsSeparator(); }
  bool ComparePaths(const char* one, const char* other) const override {
    return disk_.ComparePaths(one, other);
  }

 private:
  /// The file of this name; nullopt if it does not exist.
  std::optional<std::filesystem::path> existing(const std::string& name) const {
    std::vector<std::string> names{name};
    // Assimp puts the folder before an absolute path, and before the URI in a glTF with its escapes.
    if (const std::size_t absolute = name.find("//"); absolute != std::string::npos) {
      names.push_back(name.substr(absolute + 1));
    }
    if (name.starts_with(folder_)) {
      names.push_back(folder_ + percent_decoded(name.substr(folder_.size())));
    }
    for (const std::string& possible : names) {
      std::error_code error;
      std::filesystem::path path = std::filesystem::canonical(possible, error);
      if (!error) {
        return path;
      }
    }
    return std::nullopt;
  }

  /// The file of this name; empty if it does not exist, or is not permitted.
  std::filesystem::path permitted(const std::string& name) const {
    const auto path = existing(name);
    std::error_code error;
    if (!path || std::filesystem::is_directory(*path, error)) {
      return {};
    }
    if (std::ranges::none_of(folders_, [&](const auto& folder) { return lies_below(*path, folder); })) {
      refuse(fmt::format(
          "it refers to {}, outside of the folders of this world and its models; to permit it, add its "
          "folder to GZ_SIM_RESOURCE_PATH",
          path->string()));
      return {};
    }
    if (!std::filesystem::is_regular_file(*path, error)) {
      refuse(fmt::format("it refers to {}, which is not a regular file", path->string()));
      return {};
    }
    return *path;
  }

  void refuse(std::string why) const {
    if (refusal_.empty()) {
      refusal_ = std::move(why);
    }
  }

  const std::string folder_;  ///< of the mesh, with a slash at its end
  std::vector<std::filesystem::path> folders_;
  const std::optional<std::string>& text_;
  std::string& refusal_;
  Assimp::DefaultIOSystem disk_;
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

/// Transform to metres with z up, from the unit and the axes in an FBX file. If the file does not state them:
/// centimetres and y up, the defaults of the format.
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
    throw std::runtime_error("UpAxis, FrontAxis and CoordAxis must be three different axes, 0 to 2");
  }
  const double unit_m = 0.01 * static_cast<double>(setting("UnitScaleFactor", 1.0F));
  glm::dmat4 matrix(0.0);
  matrix[right][0] = unit_m * setting("CoordAxisSign", std::int32_t{1});
  matrix[front][1] = -unit_m * setting("FrontAxisSign", std::int32_t{1});
  matrix[up][2] = unit_m * setting("UpAxisSign", std::int32_t{1});
  matrix[3][3] = 1.0;
  return matrix;
}

/// Transform of the root node, which Assimp adds to COLLADA, 3DS and FBX. For COLLADA and 3DS it turns the
/// file to y up and applies the unit, which mesh_file does instead. For FBX, the releases of Assimp differ.
glm::dmat4 root_transform(const aiScene& scene, const std::string& extension) {
  if (extension == "dae" || extension == "3ds") {
    return glm::dmat4(1.0);
  }
  return extension == "fbx" ? fbx_axes(scene) : matrix_of(scene.mRootNode->mTransformation);
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

/// The names of a mesh in the scene that can match the submesh, from Gazebo's rule to the widest.
enum class SubmeshRule { node_name, own_names, names_above };

class Collector {
 public:
  Collector(const aiScene& scene, const std::string& submesh, SubmeshRule rule)
      : scene_(scene), submesh_(submesh), rule_(rule) {}

  void add(const aiNode& node, const glm::dmat4& T_mesh_node, const std::string& outer_name,
           bool outer_wanted) {
    const std::string given_name = given_name_of(node);
    // For Gazebo, a node without a name belongs to the nearest named node above it.
    const std::string& name = given_name.empty() ? outer_name : given_name;
    const bool has_this_name = is_wanted(given_name) || is_wanted(id_of(node));
    const bool wanted = submesh_.empty() ||
                        (rule_ == SubmeshRule::names_above && (outer_wanted || has_this_name)) ||
                        (rule_ == SubmeshRule::own_names && has_this_name) || name == submesh_;
    for (unsigned int i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
      const bool has_name = is_wanted(mesh.mName.C_Str());
      if (wanted || (rule_ != SubmeshRule::node_name && has_name)) {
        mesh_.add(triangles_of(scene_, mesh), T_mesh_node);
      }
    }
    for (unsigned int i = 0; i < node.mNumChildren; ++i) {
      const aiNode& child = *node.mChildren[i];
      add(child, T_mesh_node * matrix_of(child.mTransformation), name, outer_wanted || has_this_name);
    }
  }

  RawMesh take() { return std::move(mesh_); }

 private:
  /// Assimp invents a name for a COLLADA node without a name.
  static std::string given_name_of(const aiNode& node) {
    const std::string name = node.mName.C_Str();
    return name.starts_with("$ColladaAutoName$") ? "" : name;
  }

  static std::string id_of(const aiNode& node) {
    aiString id;
    return node.mMetaData != nullptr && node.mMetaData->Get(AI_METADATA_COLLADA_ID, id) ? id.C_Str() : "";
  }

  bool is_wanted(const std::string& name) {
    if (!name.empty()) {
      mesh_.names.push_back(name);
    }
    return !name.empty() && submesh_ == name;
  }

  const aiScene& scene_;
  const std::string& submesh_;
  const SubmeshRule rule_;
  RawMesh mesh_;
};

}  // namespace

RawMesh read_with_assimp(const MeshSource& source) {
  const std::string extension = lower_extension(source.file);
  std::optional<std::string> text;
  std::vector<std::string> warnings;
  if (extension == "obj") {
    ObjForAssimp obj = obj_for_assimp(content_of(source.file));
    if (!obj.has_faces) {
      return {};
    }
    text = std::move(obj.text);
    warnings = std::move(obj.warnings);
  } else if (extension == "dae") {
    text = collada_for_assimp(content_of(source.file), warnings);
  }
  std::string refusal;
  Assimp::Importer importer;
  importer.SetIOHandler(new WorldFiles(source, text, refusal));  // the importer owns it
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES,
                           true);  // no stand-ins for a scene without meshes
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_TEXTURES, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const aiScene* scene =
      importer.ReadFile(source.file.string(), aiProcess_Triangulate | aiProcess_SortByPType);
  if (!refusal.empty()) {
    throw std::runtime_error(refusal);
  }
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw std::runtime_error(importer.GetErrorString());
  }
  const aiNode& root = *scene->mRootNode;
  for (const SubmeshRule rule : {SubmeshRule::node_name, SubmeshRule::own_names, SubmeshRule::names_above}) {
    Collector collector(*scene, source.submesh, rule);
    collector.add(root, root_transform(*scene, extension), "", false);
    RawMesh mesh = collector.take();
    mesh.warnings = warnings;
    if (!mesh.parts.empty() || rule == SubmeshRule::names_above) {
      return mesh;
    }
  }
  return {};
}

}  // namespace sonard::render
