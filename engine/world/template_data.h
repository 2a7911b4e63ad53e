#pragma once
#include "supple/fem/element_layout.h"
#include "supple/mesh/surface.h"
#include "supple/solve/bsr3.h"

namespace supple {

/// What a BodyTemplate holds: all that depends on the mesh alone.
struct TemplateData {
    VolumeMesh mesh;
    MeshReport report;
    BoundarySurface boundary;
    std::vector<std::int32_t> boundary_vertices;  ///< ascending
    fem::ElementLayout layout;             ///< of bodies of one law: a group per kind of element
    solve::Bsr3Pattern pattern;
    std::vector<solve::GatherMap> gather;  ///< [group]
};

/// Gather maps of the groups of a layout of this mesh.
std::vector<solve::GatherMap> make_gather_maps(const VolumeMesh& mesh, const solve::Bsr3Pattern& pattern, const fem::ElementLayout& layout);

}  // namespace supple
