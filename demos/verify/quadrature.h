#pragma once
// Numerical integration over elements and boundary faces of the rest shape.
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple::verify {

/// A point of a rule: weight [m^3 or m^2], place, and the shape functions of the element or face there.
struct Point {
    double weight = 0;
    Vec3 X = Vec3::Zero();
    Vec3 normal = Vec3::Zero();            ///< of a face: outward unit normal
    std::span<const std::int32_t> vertex;
    std::array<double, 8> N{};
    std::array<Vec3, 8> gradient{};        ///< of an element: dN/dX
};

/// Tets: 14 points, exact to degree 5 (`fine`), or 4, degree 2. Hexes: 3 x 3 x 3 or 2 x 2 x 2 Gauss points.
void for_each_point(const VolumeMesh& mesh, bool fine, const std::function<void(const Point&)>& visit);

/// Points of the boundary faces whose corners all satisfy `wanted`: 3 x 3 per face, exact to degree 4 on triangles.
void for_each_face_point(const VolumeMesh& mesh, const std::function<bool(const Vec3&)>& wanted, const std::function<void(const Point&)>& visit);

/// Consistent nodal forces [N] of a traction [Pa] at X with outward normal n on the faces of `wanted`.
std::vector<Vec3> traction_forces(const VolumeMesh& mesh, const std::function<bool(const Vec3&)>& wanted,
                                  const std::function<Vec3(const Vec3& X, const Vec3& n)>& traction);

/// Consistent nodal forces [N] of a body force [N/m^3].
std::vector<Vec3> body_forces(const VolumeMesh& mesh, const std::function<Vec3(const Vec3& X)>& force);

/// Errors of the finite-element field with these positions against the exact displacement and its gradient, relative to the norms of these.
struct FieldErrors {
    double l2 = 0, h1 = 0;
};
FieldErrors field_errors(const VolumeMesh& mesh, std::span<const Vec3> positions, const std::function<Vec3(const Vec3&)>& displacement,
                         const std::function<Mat3(const Vec3&)>& gradient);

/// Relative L2 error of a stress given at the vertices (interpolated) or at the elements (constant in each).
double stress_error(const VolumeMesh& mesh, std::span<const Voigt> at_vertices, std::span<const Voigt> at_elements,
                    const std::function<Mat3(const Vec3&)>& exact);

Mat3 tensor(const Voigt& s);

}  // namespace supple::verify
