#pragma once
#include <array>
#include <mutex>
#include <optional>

#include "supple/fem/element_layout.h"
#include "supple/fem/recovery.h"
#include "supple/mesh/surface.h"
#include "supple/solve/bsr3.h"

namespace supple {

/// What a BodyTemplate holds: all that depends on the mesh alone. Fields of vertices and elements are in the order of the mesh; the rows of the matrix and the
/// blocks of elements have one of their own, along a curve through the rest shape, which nothing outside sees.
struct TemplateData {
    VolumeMesh mesh;
    Vec3 min_m = Vec3::Zero(), max_m = Vec3::Zero();  ///< bounding box of the vertices that elements use
    std::optional<MeshReport> checked;            ///< none: mesh_report() makes it
    BoundarySurface boundary;
    std::vector<std::int32_t> boundary_vertices;  ///< ascending
    fem::ElementLayout layout;             ///< of bodies of one law: a group per kind of element
    solve::Bsr3Pattern pattern;
    std::vector<solve::GatherMap> gather;  ///< [group]

    /// Made when first asked for; worlds on other threads may ask at the same time.
    const fem::RecoveryWeights& recovery(Recovery kind) const;
    const MeshReport& mesh_report() const;

private:
    mutable std::array<std::once_flag, 3> recovery_made_;
    mutable std::array<fem::RecoveryWeights, 3> recovery_;
    mutable std::once_flag report_made_;
    mutable MeshReport late_report_;
};

/// Gather maps of the groups of a layout of this mesh.
std::vector<solve::GatherMap> make_gather_maps(const VolumeMesh& mesh, const solve::Bsr3Pattern& pattern, const fem::ElementLayout& layout);

}  // namespace supple
