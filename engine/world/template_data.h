#pragma once
#include <array>
#include <mutex>

#include "supple/fem/corners.h"
#include "supple/fem/recovery.h"
#include "supple/fem/tet4.h"
#include "supple/mesh/surface.h"
#include "supple/solve/bsr3.h"

namespace supple {

/// What a BodyTemplate holds: all that depends on the mesh alone.
struct TemplateData {
    VolumeMesh mesh;
    MeshReport report;
    BoundarySurface boundary;
    std::vector<std::int32_t> boundary_vertices;  ///< ascending
    fem::Tet4Rest rest;
    fem::CornerMap corners;
    solve::Bsr3Pattern pattern;
    solve::GatherMap gather;

    /// Made when first asked for; worlds on other threads may ask at the same time.
    const fem::RecoveryWeights& recovery(Recovery kind) const;

private:
    mutable std::array<std::once_flag, 3> recovery_made_;
    mutable std::array<fem::RecoveryWeights, 3> recovery_;
};

}  // namespace supple
