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
};

/// A dead load: constant direction, acting on rest geometry, changing with time only through its table.
struct Load {
    Selection where{};
    LoadKind kind = LoadKind::total_force;
    Timeline<Vec3> value{};
};

}  // namespace supple
