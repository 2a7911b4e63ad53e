#include "supple/io/mesh_units.h"

#include <string>

#include "supple/base/error.h"

namespace supple::io {

namespace {

struct Unit {
    std::string_view name;
    double meters;
};
constexpr Unit kUnits[] = {{"m", 1}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 1e-3}, {"um", 1e-6}, {"km", 1e3}, {"in", 0.0254}, {"ft", 0.3048}};

/// Rows: which of the file's axes becomes x, y, z (1, 2, 3) and its sign.
struct Up {
    std::string_view name;
    int rows[3];
};
constexpr Up kUps[] = {{"y", {1, 2, 3}}, {"z", {1, 3, -2}}, {"x", {-2, 1, 3}}, {"-y", {1, -2, -3}}, {"-z", {1, -3, 2}}, {"-x", {2, -1, 3}}};

template <class Table>
std::string listed(const Table& table) {
    std::string out;
    for (const auto& row : table) out += (out.empty() ? "" : ", ") + std::string(row.name);
    return out;
}

}  // namespace

double MeshUnits::meters() const {
    for (const Unit& row : kUnits)
        if (unit == row.name) return scale * row.meters;
    throw Error(ErrorCode::invalid_argument, "units",
                "the unit \"" + std::string(unit) + "\" is not known; choose one of " + listed(kUnits));
}

Mat3 MeshUnits::rotation() const {
    const std::string_view axis = up.substr(!up.empty() && up.front() == '+' ? 1 : 0);
    for (const Up& row : kUps) {
        if (axis != row.name) continue;
        Mat3 R = Mat3::Zero();
        for (int i = 0; i < 3; ++i) R(i, std::abs(row.rows[i]) - 1) = row.rows[i] < 0 ? -1 : 1;
        return R;
    }
    throw Error(ErrorCode::invalid_argument, "up", "the axis \"" + std::string(up) + "\" is not known; choose one of " + listed(kUps));
}

void MeshUnits::apply(std::vector<Vec3>& vertices) const {
    const double factor = meters();
    const Mat3 R = rotation();
    for (Vec3& x : vertices) {
        if (turns()) x = (R * x).eval();
        x *= factor;
    }
}

std::vector<std::string_view> unit_names() {
    std::vector<std::string_view> names;
    for (const Unit& row : kUnits) names.push_back(row.name);
    return names;
}

std::vector<std::string_view> axis_names() {
    std::vector<std::string_view> names;
    for (const Up& row : kUps) names.push_back(row.name);
    return names;
}

}  // namespace supple::io
