#pragma once
#include <cstdint>
#include <vector>

#include "supple/mesh/selection.h"

namespace supple {

/// Which coordinates a support holds.
struct Axes {
    bool x = true, y = true, z = true;
};

/// A quantity over time: linear between the entries, constant before the first and after the last. Empty times: `values[0]` always.
template <class T>
struct Timeline {
    std::vector<double> times_s{};  ///< strictly ascending; empty or as many as values
    std::vector<T> values{};        ///< at least one

    T at(double time_s) const {
        if (times_s.empty() || time_s <= times_s.front()) return values.front();
        std::size_t i = 1;
        while (i < times_s.size() && times_s[i] < time_s) ++i;
        if (i == times_s.size()) return values.back();
        const double s = (time_s - times_s[i - 1]) / (times_s[i] - times_s[i - 1]);
        return T((1.0 - s) * values[i - 1] + s * values[i]);
    }
};

/// Prescribed motion of selected vertices. Exactly one of the three is set (non-empty values).
struct Motion {
    Selection where{};
    Axes axes{};                     ///< the coordinates that follow; the others stay free
    Timeline<Vec3> displacement_m{}; ///< from the start position (rest position + BodyDef::translation_m)
    Timeline<Vec3> velocity_m_s{};
    Timeline<Mat34> affine{};        ///< position = A X + t of the start position X
};

enum class LoadKind {
    total_force,       ///< value [N] shared by the selected vertices in equal parts
    force_per_vertex,  ///< value [N] on each selected vertex
    traction,          ///< value [Pa] on the boundary triangles whose three vertices are selected; dead (rest area, fixed direction)
    body_force,        ///< value [N/m^3] on the elements whose vertices are all selected
    pressure,          ///< amount [Pa] on the boundary triangles whose three vertices are selected; positive pushes into the body
    moment,            ///< amount [N m] about `axis`, a couple: no resultant force, so its torque is the same about every point
};

/// Something that pushes a body. The first four kinds are dead: constant direction, acting on rest geometry, changing with time only through
/// their table.
///
/// `pressure`, follower: -p n da on the present triangles, a third to each corner, taken where the step evaluates its forces (at first the
/// prediction x + h v). Not follower: the same on the rest shape, a dead load. On a closed surface both sum to no force and no torque.
///
/// `moment`: the traction omega x (x - c) on the boundary triangles of the selection (equal point forces on its vertices where it holds no
/// triangle), c its centroid, omega such that the torque is amount * axis at every moment, however far the selection has turned. On the end of a beam this
/// is the linear distribution of beam theory. Follower: the axis turns with the selection (the rotation that fits it best); otherwise it stays
/// as it is in space.
///
/// What follows the body has a stiffness of its own. That of pressures (its symmetric part: all of it on a closed surface) is in the tangent where Newton goes to a tolerance; that of
/// moments never is, so that Newton converges linearly in it.
struct Load {
    Selection where{};
    LoadKind kind = LoadKind::total_force;
    Timeline<Vec3> value{};                ///< of the first four kinds
    Timeline<double> amount{};             ///< of pressure and moment
    Vec3 axis = Vec3::Zero();              ///< of a moment; any length but zero, only its direction counts
    bool follower = true;                  ///< of pressure and moment
    std::vector<std::int32_t> triangles{}; ///< traction, pressure and moment: these of BoundarySurface::triangles instead of `where`
};

}  // namespace supple
