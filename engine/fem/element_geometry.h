#pragma once
#include <array>
#include <span>

#include "supple/mesh/volume_mesh.h"

namespace supple::fem {

/// Rest shape of one element of a mesh, whatever its kind, at its centre: slow and plain, for inspection and for what is made once per mesh.
struct ElementGeometry {
    std::size_t corners = 0;               ///< 4 or 8
    std::array<std::int32_t, 8> vertex{};  ///< in the order of the mesh
    std::array<Vec3, 8> gradient;          ///< of the shape functions at the centre [1/m]
    Vec3 centre = Vec3::Zero();            ///< [m]
    double volume = 0;                     ///< [m^3]

    /// F = sum x_a g_a^T at the centre, of positions in the order of the mesh.
    Mat3 deformation_gradient(std::span<const Vec3> positions) const;
};

/// @param element  in the order of the mesh: tets, then hexes
ElementGeometry element_geometry(const VolumeMesh& mesh, std::size_t element);

}  // namespace supple::fem
