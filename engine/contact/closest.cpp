#include "supple/contact/closest.h"

#include <algorithm>
#include <cmath>

#include "supple/mesh/triangle_tree.h"

namespace supple::contact {

namespace {

constexpr int kDescents = 24;    // towards a corner each
constexpr int kHalvings = 16;    // of a line search
constexpr int kSections = 16;     // of the golden section
constexpr int kMarches = 200;
constexpr double kFlat = 1e-3;   // of the triangle's size: a gain that is none
constexpr double kPull = 0.1;    // towards the middle of a triangle, of its size at its size's distance

/// What is made least: the distance, and a little for being far from the middle. Where a triangle lies flat on a face, or along an edge, many points are as deep;
/// this chooses one that moves smoothly with the two.
struct Depth {
    const Shape& shape;
    Vec3 middle;
    double size, pull;

    Depth(const Shape& s, const Vec3& a, const Vec3& b, const Vec3& c)
        : shape(s), middle((a + b + c) / 3), size(std::max((b - a).norm(), (c - a).norm())), pull(size > 0 ? kPull / size : 0) {}
    double value(double d, const Vec3& p) const { return d + pull * (p - middle).squaredNorm(); }
    Vec3 slope(const Distance& at, const Vec3& p) const { return at.normal + 2 * pull * (p - middle); }
    Vec3 slope(const Vec3& p) const { return slope(distance(shape, p), p); }
};

struct Candidate {
    TrianglePoint point;
    Vec3 p = Vec3::Zero();
    double value = 0;
};

Candidate look_at(const Depth& depth, const Vec3& barycentric, const Vec3& p) {
    const Distance at = distance(depth.shape, p);
    return {{barycentric, at}, p, depth.value(at.d, p)};
}

/// Where along p -> q it is least: by its slope, which changes its sign once where the distance is convex.
double least_along(const Depth& depth, const Vec3& p, const Vec3& q) {
    const Vec3 way = q - p;
    if (depth.slope(q).dot(way) <= 0) return 1;
    double low = 0, high = 1;
    for (int i = 0; i < kHalvings; ++i) {
        const double half = 0.5 * (low + high);
        (depth.slope(p + half * way).dot(way) <= 0 ? low : high) = half;
    }
    return 0.5 * (low + high);
}

/// Lines across the triangle, the least on each, and the golden section over the lines: slow, but creases of the distance do not stop it.
Candidate search_lines(const Depth& depth, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto on_line = [&](double s) {
        const Vec3 p = a + s * (b - a), q = a + s * (c - a);
        const double t = least_along(depth, p, q);
        return look_at(depth, Vec3(1 - s, s * (1 - t), s * t), p + t * (q - p));
    };
    constexpr double kGolden = 0.6180339887498949;
    double low = 0, high = 1, s1 = 1 - kGolden, s2 = kGolden;
    Candidate p1 = on_line(s1), p2 = on_line(s2);
    for (int i = 0; i < kSections; ++i) {
        if (p1.value <= p2.value) {
            high = s2;
            s2 = s1;
            p2 = p1;
            s1 = high - kGolden * (high - low);
            p1 = on_line(s1);
        } else {
            low = s1;
            s1 = s2;
            p1 = p2;
            s2 = low + kGolden * (high - low);
            p2 = on_line(s2);
        }
    }
    const Candidate side = on_line(1);
    const Candidate& inner = p1.value <= p2.value ? p1 : p2;
    return side.value < inner.value ? side : inner;
}

}  // namespace

TrianglePoint deepest_on_triangle(const Shape& shape, const Vec3& a, const Vec3& b, const Vec3& c) {
    if (std::holds_alternative<SphereShape>(shape)) {
        const NearestPoint at = nearest_on_triangle(Vec3::Zero(), a, b, c);
        return {Vec3(at.barycentric[0], at.barycentric[1], at.barycentric[2]), distance(shape, at.point)};
    }
    const Depth depth(shape, a, b, c);
    const std::array<Vec3, 3> corner = {a, b, c};
    Candidate best = look_at(depth, Vec3::UnitX(), a);
    for (int k = 1; k < 3; ++k) {
        const Candidate at = look_at(depth, Vec3::Unit(k), corner[std::size_t(k)]);
        if (at.value < best.value) best = at;
    }
    for (int step = 0; step < kDescents; ++step) {
        // Towards the corner where the tangent plane is lowest; none is lower: this is the least.
        const Vec3 gradient = depth.slope(best.point.at, best.p);
        std::size_t to = 0;
        double slope = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double s = gradient.dot(corner[k] - best.p);
            if (s < slope) {
                slope = s;
                to = k;
            }
        }
        if (slope > -kFlat * depth.size) break;
        const double part = least_along(depth, best.p, corner[to]);
        const Candidate next = look_at(depth, (1 - part) * best.point.barycentric + part * Vec3::Unit(Eigen::Index(to)), best.p + part * (corner[to] - best.p));
        const bool creased = !(next.value < best.value - kFlat * depth.size);  // or hardly any slope
        if (next.value < best.value) best = next;
        if (!creased) continue;
        const Candidate thorough = search_lines(depth, a, b, c);
        return thorough.value < best.value ? thorough.point : best.point;
    }
    return best.point;
}

std::optional<Touch> sweep_point(const Shape& shape, const Vec3& p0, const Vec3& p1, double near_m) {
    const double length = (p1 - p0).norm();
    Touch touch;
    touch.point.at = distance(shape, p0);
    if (!(touch.point.at.d > near_m)) return std::nullopt;
    for (int i = 0; i < kMarches && length > 0; ++i) {
        touch.time += touch.point.at.d / length;
        if (!(touch.time <= 1)) return std::nullopt;
        touch.point.at = distance(shape, p0 + touch.time * (p1 - p0));
        if (touch.point.at.d <= near_m) return touch;
    }
    return std::nullopt;
}

std::optional<Touch> sweep_triangle(const Shape& shape, const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to, double near_m) {
    double length = 0;  // no point of the triangle moves farther
    for (std::size_t k = 0; k < 3; ++k) length = std::max(length, (to[k] - from[k]).norm());
    const auto look = [&](double t) {
        return deepest_on_triangle(shape, from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), from[2] + t * (to[2] - from[2]));
    };
    Touch touch;
    touch.point = look(0);
    if (!(touch.point.at.d > near_m)) return std::nullopt;
    for (int i = 0; i < kMarches && length > 0; ++i) {
        touch.time += touch.point.at.d / length;
        if (!(touch.time <= 1)) return std::nullopt;
        touch.point = look(touch.time);
        if (touch.point.at.d <= near_m) return touch;
    }
    return std::nullopt;
}

}  // namespace supple::contact
