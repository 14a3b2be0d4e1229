// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/osg_plugin.hpp"

#include <string>

#include <osgDB/ObjectWrapper>
#include <osgDB/Registry>

#include "renderer/scene/local_file.hpp"

namespace sonard::render {

void load_osg_plugin(const std::filesystem::path& file) {
  osgDB::Registry& registry = *osgDB::Registry::instance();
  const std::string extension = lower_extension(file);
  registry.getReaderWriterForExtension(extension);
  if (extension.starts_with("osg")) {
    for (const char* of_each_library : {"osg::Node", "osgSim::LightPointNode", "osgUtil::CullVisitor"}) {
      registry.getObjectWrapperManager()->findWrapper(of_each_library);
    }
  }
}

}  // namespace sonard::render
