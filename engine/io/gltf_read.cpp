// glTF through assimp, where the engine is built with it.
#include "supple/io/surface_builder.h"
#include "supple/io/surface_formats.h"

#ifdef SUPPLE_WITH_ASSIMP
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace supple::io {

#ifdef SUPPLE_WITH_ASSIMP
namespace {

constexpr int kDeepest = 256;

void add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, SurfaceBuilder& builder, const std::string& name,
              int depth) {
    if (depth > kDeepest) throw Error(ErrorCode::unsupported, name, "the nodes of the scene are nested more than 256 deep");
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
        const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
        const bool mirrored = transform.Determinant() < 0;
        for (unsigned f = 0; f < part.mNumFaces; ++f) {
            const aiFace& face = part.mFaces[f];
            if (face.mNumIndices != 3) continue;  // points and lines
            std::int32_t corner[3];
            for (int c = 0; c < 3; ++c) {
                const aiVector3D x = transform * part.mVertices[face.mIndices[c]];
                const Vec3 position(double(x.x), double(x.y), double(x.z));
                if (!position.allFinite()) throw Error(ErrorCode::parse, name, "a vertex position is not finite");
                corner[c] = builder.weld_vertex(position);
            }
            mirrored ? builder.add_triangle(corner[0], corner[2], corner[1]) : builder.add_triangle(corner[0], corner[1], corner[2]);
        }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add_node(scene, *node.mChildren[c], transform, builder, name, depth + 1);
}

}  // namespace

mesh::TriangleMesh parse_gltf(const MeshSource& source) {
    Assimp::Importer importer;
    const bool binary = source.bytes.substr(0, 4) == "glTF";
    const aiScene* scene = source.folder.empty() ? importer.ReadFileFromMemory(source.bytes.data(), source.bytes.size(),
                                                                               aiProcess_Triangulate, binary ? "glb" : "gltf")
                                                 : importer.ReadFile(source.name, aiProcess_Triangulate);
    if (!scene || !scene->mRootNode)
        throw Error(ErrorCode::parse, source.name, std::string("assimp cannot read it: ") + importer.GetErrorString());
    SurfaceBuilder builder;
    add_node(*scene, *scene->mRootNode, aiMatrix4x4(), builder, source.name, 0);
    return builder.finish(TextScanner({}, source.name));
}
#else
mesh::TriangleMesh parse_gltf(const MeshSource& source) {
    throw Error(ErrorCode::unsupported, source.name,
                "this is a glTF file, and this build of the engine was made without assimp; install libassimp-dev and build again, or save "
                "it as OBJ");
}
#endif

}  // namespace supple::io
