#include "supple/io/polygon.h"

#include <Eigen/Geometry>

namespace supple::io {

namespace {

constexpr std::size_t kMostEars = 256;

Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

void append_quad(std::span<const std::int32_t> c, std::span<const Vec3> x, std::vector<Triangle>& triangles) {
    const Vec3 &a = x[c[0]], &b = x[c[1]], &d = x[c[2]], &e = x[c[3]];
    const double first = area_vector(a, b, d).dot(area_vector(a, d, e));
    const double second = area_vector(b, d, e).dot(area_vector(b, e, a));
    if (first > 0 || !(second > 0)) {
        triangles.push_back({c[0], c[1], c[2]});
        triangles.push_back({c[0], c[2], c[3]});
    } else {
        triangles.push_back({c[1], c[2], c[3]});
        triangles.push_back({c[1], c[3], c[0]});
    }
}

bool is_inside(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
    return area_vector(a, b, p).dot(normal) >= 0 && area_vector(b, c, p).dot(normal) >= 0 && area_vector(c, a, p).dot(normal) >= 0;
}

bool is_ear(std::span<const std::int32_t> left, std::size_t i, std::span<const Vec3> x, const Vec3& normal) {
    const std::size_t n = left.size();
    const std::int32_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
    if (!(area_vector(x[a], x[b], x[c]).dot(normal) > 0)) return false;
    for (const std::int32_t v : left)
        if (v != a && v != b && v != c && is_inside(x[v], x[a], x[b], x[c], normal)) return false;
    return true;
}

void append_ears(std::span<const std::int32_t> corners, std::span<const Vec3> x, std::vector<Triangle>& triangles) {
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) normal += area_vector(x[corners[0]], x[corners[i]], x[corners[i + 1]]);
    std::vector<std::int32_t> left(corners.begin(), corners.end());
    while (left.size() > 3) {
        std::size_t ear = 0;
        while (ear < left.size() && !is_ear(left, ear, x, normal)) ++ear;
        if (ear == left.size()) ear = 1;  // a polygon that crosses itself has no ear: go on anyhow, as a fan does
        const std::size_t n = left.size();
        triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
        left.erase(left.begin() + std::ptrdiff_t(ear));
    }
    triangles.push_back({left[0], left[1], left[2]});
}

}  // namespace

void append_polygon(std::span<const std::int32_t> corners, std::span<const Vec3> vertices, std::vector<Triangle>& triangles) {
    if (corners.size() == 4) return append_quad(corners, vertices, triangles);
    if (corners.size() > 4 && corners.size() <= kMostEars) return append_ears(corners, vertices, triangles);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) triangles.push_back({corners[0], corners[i], corners[i + 1]});
}

}  // namespace supple::io
