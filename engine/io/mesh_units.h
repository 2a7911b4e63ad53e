#pragma once
#include <string_view>
#include <vector>

#include "supple/mesh/triangle_mesh.h"

namespace supple::io {

/// How the lengths and axes of a file become metres and a y axis that points up.
struct MeshUnits {
    double scale = 1;             ///< > 0, beside the unit
    std::string_view unit = "m";  ///< "m", "dm", "cm", "mm", "um", "km", "in", "ft"
    std::string_view up = "y";    ///< the file's axis that becomes +y: "x", "y", "z", "-x", "-y", "-z"; a rotation, nothing is mirrored

    /// Metres per length of the file. @error Error(invalid_argument) naming the known units
    double meters() const;
    /// @error Error(invalid_argument) naming the six axes
    Mat3 rotation() const;
    bool turns() const { return up != "y" && up != "+y"; }
    /// Turns, then scales. "m" and "y" with scale 1 leave the bits as they are.
    void apply(std::vector<Vec3>& vertices) const;
};

std::vector<std::string_view> unit_names();
std::vector<std::string_view> axis_names();

}  // namespace supple::io
