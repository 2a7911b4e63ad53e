#include <set>

#include "supple/base/error.h"
#include "supple/mesh/edit_draft.h"

namespace supple {

namespace {

[[noreturn]] void refuse(const char* where, const std::string& message) { throw Error(ErrorCode::invalid_argument, where, message); }

}  // namespace

MeshEdit remove_elements(const VolumeMesh& mesh, std::span<const std::int32_t> chosen) {
    mesh::Draft draft(mesh);
    std::set<std::int32_t> affected;
    for (const std::int32_t e : chosen) {
        if (e < 0 || std::size_t(e) >= mesh.element_count())
            refuse("remove_elements", "element " + std::to_string(e) + " is outside [0, " + std::to_string(mesh.element_count()) + ")");
        mesh::DraftElement& element = draft.elements[std::size_t(e)];
        element.alive = false;
        for (std::int32_t a = 0; a < element.corners; ++a) affected.insert(element.vertex[std::size_t(a)]);
    }
    if (!affected.empty()) draft.separate({}, affected, true);
    MeshEdit edit = draft.finish();
    if (edit.mesh.element_count() == 0) refuse("remove_elements", "no element would be left of " + std::to_string(mesh.element_count()) + "; remove the body instead");
    return edit;
}

MeshEdit separate_faces(const VolumeMesh& mesh, std::span<const ElementFace> chosen) {
    mesh::Draft draft(mesh);
    std::set<mesh::FaceKey> torn;
    std::set<std::int32_t> affected;
    for (const ElementFace& f : chosen) {
        if (f.element < 0 || std::size_t(f.element) >= mesh.element_count())
            refuse("separate_faces", "element " + std::to_string(f.element) + " is outside [0, " + std::to_string(mesh.element_count()) + ")");
        if (f.face < 0 || f.face >= draft.faces(f.element))
            refuse("separate_faces", "face " + std::to_string(f.face) + " is outside [0, " + std::to_string(draft.faces(f.element)) + ") of element " + std::to_string(f.element));
        const mesh::FaceKey key = draft.face(f.element, f.face);
        torn.insert(key);
        for (const std::int32_t v : key)
            if (v >= 0) affected.insert(v);
    }
    if (!torn.empty()) draft.separate(torn, affected, false);
    return draft.finish();
}

}  // namespace supple
