#include "supple/contact/closest.h"

#include <algorithm>
#include <cmath>

namespace supple::contact {

Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    const Vec3 bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        const double s = d1 / (d1 - d3);
        return {1 - s, s, 0};
    }
    const Vec3 cp = p - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        const double s = d2 / (d2 - d6);
        return {1 - s, 0, s};
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return {0, 1 - s, s};
    }
    const double sum = va + vb + vc;
    if (!(sum > 0)) return {1, 0, 0};  // no area: any corner of it
    return {va / sum, vb / sum, vc / sum};
}

namespace {

constexpr int kDescents = 24;    // towards a corner each
constexpr int kHalvings = 16;    // of a line search
constexpr int kSections = 16;     // of the golden section
constexpr int kMarches = 200;
constexpr double kFlat = 1e-3;   // of the triangle's size: a gain that is none

/// Where along p -> q the distance is least: by its slope, which changes its sign once where the distance is convex.
double least_along(const Shape& shape, const Vec3& p, const Vec3& q) {
    const Vec3 way = q - p;
    if (distance(shape, q).normal.dot(way) <= 0) return 1;
    double low = 0, high = 1;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (distance(shape, p + middle * way).normal.dot(way) <= 0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Lines across the triangle, the least on each, and the golden section over the lines: slow, but creases of the distance do not stop it.
TrianglePoint search_lines(const Shape& shape, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto on_line = [&](double s) {
        const Vec3 p = a + s * (b - a), q = a + s * (c - a);
        const double t = least_along(shape, p, q);
        return TrianglePoint{Vec3(1 - s, s * (1 - t), s * t), distance(shape, p + t * (q - p))};
    };
    constexpr double kGolden = 0.6180339887498949;
    double low = 0, high = 1, s1 = 1 - kGolden, s2 = kGolden;
    TrianglePoint p1 = on_line(s1), p2 = on_line(s2);
    for (int i = 0; i < kSections; ++i) {
        if (p1.at.d <= p2.at.d) {
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
    const TrianglePoint side = on_line(1);
    const TrianglePoint& inner = p1.at.d <= p2.at.d ? p1 : p2;
    return side.at.d < inner.at.d ? side : inner;
}

}  // namespace

TrianglePoint deepest_on_triangle(const Shape& shape, const Vec3& a, const Vec3& b, const Vec3& c) {
    TrianglePoint best;
    if (std::holds_alternative<SphereShape>(shape)) {
        best.barycentric = closest_on_triangle(a, b, c, Vec3::Zero());
        best.at = distance(shape, best.barycentric[0] * a + best.barycentric[1] * b + best.barycentric[2] * c);
        return best;
    }
    const std::array<Vec3, 3> corner = {a, b, c};
    for (int k = 0; k < 3; ++k) {
        const Distance at = distance(shape, corner[std::size_t(k)]);
        if (k == 0 || at.d < best.at.d) best = {Vec3::Unit(k), at};
    }
    const double size = std::max((b - a).norm(), (c - a).norm());
    for (int step = 0; step < kDescents; ++step) {
        const Vec3& w = best.barycentric;
        const Vec3 p = w[0] * a + w[1] * b + w[2] * c;
        // Towards the corner where the tangent plane of the distance is lowest; none is lower: this is the least.
        std::size_t to = 0;
        double slope = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double s = best.at.normal.dot(corner[k] - p);
            if (s < slope) {
                slope = s;
                to = k;
            }
        }
        if (slope > -kFlat * size) break;
        const double part = least_along(shape, p, corner[to]);
        const Vec3 next = (1 - part) * w + part * Vec3::Unit(Eigen::Index(to));
        const Distance at = distance(shape, p + part * (corner[to] - p));
        if (!(at.d < best.at.d - kFlat * size)) {  // a crease, or hardly any slope
            if (at.d < best.at.d) best = {next, at};
            const TrianglePoint thorough = search_lines(shape, a, b, c);
            return thorough.at.d < best.at.d ? thorough : best;
        }
        best = {next, at};
    }
    return best;
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
