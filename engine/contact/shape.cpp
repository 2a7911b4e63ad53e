#include "supple/contact/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "supple/base/error.h"
#include "supple/contact/distance_grid.h"

namespace supple::contact {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;

/// A vector's unit vector, or `otherwise` where it has none.
Vec3 unit_or(const Vec3& v, double length, const Vec3& otherwise) { return length > 0 ? Vec3(v / length) : otherwise; }

/// Distance from a point at distance `q[i]` beyond each of some orthogonal faces (negative: within), `axis[i]` their outward unit vectors.
template <std::size_t N>
Distance from_faces(const std::array<double, N>& q, const std::array<Vec3, N>& axis) {
    double outside = 0;
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < N; ++i) {
        if (q[i] > 0) outside += q[i] * q[i];
        if (q[i] > q[nearest]) nearest = i;
    }
    if (outside == 0) return {q[nearest], axis[nearest]};
    const double d = std::sqrt(outside);
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 0; i < N; ++i) {
        if (q[i] > 0) normal += q[i] / d * axis[i];
    }
    return {d, normal};
}

struct DistanceOf {
    const Vec3& p;

    Distance operator()(const PlaneShape& s) const { return {s.normal.dot(p) - s.offset_m, s.normal}; }
    Distance operator()(const SphereShape& s) const {
        const double r = p.norm();
        return {r - s.radius_m, unit_or(p, r, Vec3(0, 1, 0))};
    }
    Distance operator()(const CapsuleShape& s) const {
        const Vec3 out(p.x(), p.y() - std::clamp(p.y(), -s.half_length_m, s.half_length_m), p.z());
        const double r = out.norm();
        return {r - s.radius_m, unit_or(out, r, Vec3(1, 0, 0))};
    }
    Distance operator()(const BoxShape& s) const {
        std::array<double, 3> q{};
        std::array<Vec3, 3> axis;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto c = Eigen::Index(i);
            q[i] = std::abs(p[c]) - s.half_extents_m[c];
            axis[i] = Vec3::Unit(c) * (p[c] < 0 ? -1.0 : 1.0);
        }
        return from_faces(q, axis);
    }
    Distance operator()(const CylinderShape& s) const {
        const Vec3 radial(p.x(), 0, p.z());
        const double r = radial.norm();
        return from_faces<2>({std::abs(p.y()) - s.half_length_m, r - s.radius_m},
                             {Vec3(0, p.y() < 0 ? -1.0 : 1.0, 0), unit_or(radial, r, Vec3(1, 0, 0))});
    }
    Distance operator()(const MeshShape& s) const { return s.grid->distance(p); }
};

struct BoundsOf {
    static Bounds symmetric(const Vec3& half) { return {-half, half}; }
    Bounds operator()(const PlaneShape&) const { return symmetric(Vec3::Constant(kInfinite)); }
    Bounds operator()(const SphereShape& s) const { return symmetric(Vec3::Constant(s.radius_m)); }
    Bounds operator()(const CapsuleShape& s) const { return symmetric(Vec3(s.radius_m, s.half_length_m + s.radius_m, s.radius_m)); }
    Bounds operator()(const BoxShape& s) const { return symmetric(s.half_extents_m); }
    Bounds operator()(const CylinderShape& s) const { return symmetric(Vec3(s.radius_m, s.half_length_m, s.radius_m)); }
    Bounds operator()(const MeshShape& s) const { return s.grid->bounds(); }
};

struct ThinnessOf {
    double operator()(const PlaneShape&) const { return kInfinite; }
    double operator()(const SphereShape& s) const { return s.radius_m; }
    double operator()(const CapsuleShape& s) const { return s.radius_m; }
    double operator()(const BoxShape& s) const { return s.half_extents_m.minCoeff(); }
    double operator()(const CylinderShape& s) const { return std::min(s.radius_m, s.half_length_m); }
    double operator()(const MeshShape& s) const { return s.grid->depth_m(); }
};

struct FeatureRadiusOf {
    double operator()(const PlaneShape&) const { return kInfinite; }
    double operator()(const SphereShape& s) const { return s.radius_m; }
    double operator()(const CapsuleShape& s) const { return s.radius_m; }
    template <class Edged>
    double operator()(const Edged&) const {
        return 0;
    }
};

/// A cylinder about y: its inertia about and across its axis.
MassProperties about_y(double volume, double axial, double across) {
    return {volume, Vec3::Zero(), Vec3(across, axial, across).asDiagonal()};
}

struct MassOf {
    MassProperties operator()(const PlaneShape&) const { return {}; }
    MassProperties operator()(const SphereShape& s) const {
        const double volume = 4.0 / 3.0 * kPi * std::pow(s.radius_m, 3);
        return {volume, Vec3::Zero(), 0.4 * volume * s.radius_m * s.radius_m * Mat3::Identity()};
    }
    MassProperties operator()(const CapsuleShape& s) const {
        // Cylinder and two half balls; a half ball's centre is 3/8 r from its flat face.
        const double r = s.radius_m, l = s.half_length_m;
        const double tube = 2 * kPi * r * r * l, ball = 4.0 / 3.0 * kPi * r * r * r;
        const double axial = 0.5 * tube * r * r + 0.4 * ball * r * r;
        const double across = tube * (r * r / 4 + l * l / 3) + ball * (0.4 * r * r + l * l + 0.75 * l * r);
        return about_y(tube + ball, axial, across);
    }
    MassProperties operator()(const BoxShape& s) const {
        const Vec3 e2 = s.half_extents_m.cwiseAbs2();
        const double volume = 8 * s.half_extents_m.prod();
        return {volume, Vec3::Zero(), (volume / 3 * Vec3(e2.y() + e2.z(), e2.z() + e2.x(), e2.x() + e2.y())).asDiagonal()};
    }
    MassProperties operator()(const CylinderShape& s) const {
        const double r2 = s.radius_m * s.radius_m, volume = 2 * kPi * r2 * s.half_length_m;
        return about_y(volume, 0.5 * volume * r2, volume * (r2 / 4 + s.half_length_m * s.half_length_m / 3));
    }
    MassProperties operator()(const MeshShape& s) const { return s.grid->mass_properties(); }
};

struct Check {
    const std::string& where;
    void size(double value, const char* field) const { require_in_range(value, 1e-9, 1e6, where + "." + field, "a size in metres"); }
    void operator()(PlaneShape& s) const {
        const double length = s.normal.norm();
        if (!(length > 1e-150) || !std::isfinite(length)) throw Error(ErrorCode::invalid_argument, where + ".normal", "is zero or not finite; give a direction");
        require_in_range(s.offset_m, -1e9, 1e9, where + ".offset_m");
        s.normal /= length;
    }
    void operator()(SphereShape& s) const { size(s.radius_m, "radius_m"); }
    void operator()(CapsuleShape& s) const {
        size(s.radius_m, "radius_m");
        size(s.half_length_m, "half_length_m");
    }
    void operator()(BoxShape& s) const {
        for (const double e : {s.half_extents_m.x(), s.half_extents_m.y(), s.half_extents_m.z()}) size(e, "half_extents_m");
    }
    void operator()(CylinderShape& s) const {
        size(s.radius_m, "radius_m");
        size(s.half_length_m, "half_length_m");
    }
    void operator()(MeshShape& s) const {
        if (!s.grid) throw Error(ErrorCode::invalid_argument, where + ".grid", "is null; make one with contact::DistanceGrid::build(vertices, triangles)");
    }
};

}  // namespace

void check_shape(Shape& shape, const std::string& where) { std::visit(Check{where}, shape); }
Distance distance(const Shape& shape, const Vec3& p) { return std::visit(DistanceOf{p}, shape); }
Bounds bounds(const Shape& shape) { return std::visit(BoundsOf{}, shape); }
double thinness_m(const Shape& shape) { return std::visit(ThinnessOf{}, shape); }
double feature_radius_m(const Shape& shape) { return std::visit(FeatureRadiusOf{}, shape); }
MassProperties mass_properties(const Shape& shape) { return std::visit(MassOf{}, shape); }

}  // namespace supple::contact
