#include "supple/fem/element_geometry.h"

#include <Eigen/LU>

namespace supple::fem {

Mat3 ElementGeometry::deformation_gradient(std::span<const Vec3> positions) const {
    Mat3 F = Mat3::Zero();
    const Vec3 origin = positions[std::size_t(vertex[0])];  // differences: the gradients sum to zero
    for (std::size_t a = 1; a < corners; ++a) F += (positions[std::size_t(vertex[a])] - origin) * gradient[a].transpose();
    return F;
}

ElementGeometry element_geometry(const VolumeMesh& mesh, std::size_t element) {
    ElementGeometry g;
    const auto at = [&](std::size_t a) -> const Vec3& { return mesh.vertices[std::size_t(g.vertex[a])]; };
    std::array<Vec3, 8> local;  // derivatives of the shape functions in the element's own coordinates
    if (element < mesh.tets.size()) {
        g.corners = 4;
        for (std::size_t a = 0; a < 4; ++a) g.vertex[a] = mesh.tets[element][a];
        local = {Vec3(-1, -1, -1), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
        g.volume = tet_volume(at(0), at(1), at(2), at(3));
    } else {
        g.corners = 8;
        g.vertex = mesh.hexes[element - mesh.tets.size()];
        for (std::size_t a = 0; a < 8; ++a) {
            const bool x = a == 1 || a == 2 || a == 5 || a == 6, y = a == 2 || a == 3 || a == 6 || a == 7, z = a >= 4;
            local[a] = 0.25 * Vec3(x ? 1 : -1, y ? 1 : -1, z ? 1 : -1);
        }
        g.volume = hex_volume({at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)});
    }
    Mat3 J = Mat3::Zero();
    for (std::size_t a = 0; a < g.corners; ++a) {
        J += at(a) * local[a].transpose();
        g.centre += at(a) / double(g.corners);
    }
    const Mat3 to_rest = J.inverse().transpose();
    for (std::size_t a = 0; a < g.corners; ++a) g.gradient[a] = to_rest * local[a];
    return g;
}

}  // namespace supple::fem
