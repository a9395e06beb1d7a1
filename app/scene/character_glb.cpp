#include "app/scene/character_glb.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>
#include <memory>

#include "app/scene/assimp_scene.h"
#include "app/scene/files.h"
#include "common/error.h"
#include "common/files.h"

namespace mocaplm {

namespace {

aiMatrix4x4 matrix_from(const Eigen::Matrix4d& m) {
  aiMatrix4x4 matrix;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column)
      matrix[row][column] = static_cast<float>(m(row, column));
  return matrix;
}

// Nodes by name as they stand in the scene that read_with_assimp gives, which has been corrected.
// Of several nodes of one name the first.
void stand_as(const Scene& scene, aiNode& root) {
  for (const SceneNode& node : scene.nodes)
    if (aiNode* found = root.FindNode(node.name.c_str()))
      found->mTransformation = matrix_from(node.local);
}

// The file's unit and axes, as a node above all: bones and skin follow it alike.
void into_our_world(const Scene& scene, aiNode& root) {
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
  world.topLeftCorner<3, 3>() = scene.unit * scene.axes;
  root.mTransformation = matrix_from(world) * root.mTransformation;
}

void drop_animations(aiScene& scene) {
  for (unsigned i = 0; i < scene.mNumAnimations; ++i) delete scene.mAnimations[i];
  delete[] scene.mAnimations;
  scene.mAnimations = nullptr;
  scene.mNumAnimations = 0;
}

}  // namespace

std::string character_glb(const std::filesystem::path& path) {
  const std::string file = path.string();
  const Scene scene = read_with_assimp(path);
  if (scene.skins.empty())
    throw DataError(in_file(file),
                    "has no mesh that a skeleton moves; expected a character with "
                    "its skin");
  const std::string bytes = read_file(path);
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetIOHandler(new SceneFiles("scene.fbx", bytes, {}));  // which owns it
  if (importer.ReadFile("scene.fbx", aiProcess_Triangulate | aiProcess_LimitBoneWeights |
                                         aiProcess_JoinIdenticalVertices | aiProcess_SortByPType) ==
      nullptr)
    throw DataError(in_file(file),
                    std::string("assimp cannot read it as an FBX: ") + importer.GetErrorString());
  const std::unique_ptr<aiScene> own(importer.GetOrphanedScene());
  stand_as(scene, *own->mRootNode);
  into_our_world(scene, *own->mRootNode);
  drop_animations(*own);
  Assimp::Exporter exporter;
  const aiExportDataBlob* blob = exporter.ExportToBlob(own.get(), "glb2");
  if (blob == nullptr || blob->size == 0)
    throw DataError(in_file(file),
                    std::string("assimp cannot turn it into a .glb: ") + exporter.GetErrorString());
  return std::string(static_cast<const char*>(blob->data), blob->size);
}

}  // namespace mocaplm
