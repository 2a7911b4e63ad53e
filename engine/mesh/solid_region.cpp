#include "supple/mesh/solid_region.h"

#include "supple/mesh/refine.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {
namespace {

// A winding number this near to a whole number is not that of a place in or before a hole.
constexpr double kSettled = 0.2;
constexpr double kBeyond = 0.05;  // of a cell's side: a step across a surface

/// Six times the enclosed volume, seen from the middle of the box: its sign says which way round an (almost) closed surface is wound.
double six_volumes(const mesh::TriangleMesh& surface, const Vec3& middle) {
    double sum = 0;
    for (const Triangle& t : surface.triangles) {
        const Vec3 a = surface.vertices[std::size_t(t[0])] - middle, b = surface.vertices[std::size_t(t[1])] - middle;
        sum += a.cross(b).dot(surface.vertices[std::size_t(t[2])] - middle);
    }
    return sum;
}

/// Part of a cube of side h whose centre has signed distance d that is inside, as if the surface were a plane across it.
double plane_fraction(double d, double h) { return std::clamp(0.5 - d / h, 0.0, 1.0); }

}  // namespace

SolidRegion::SolidRegion(const mesh::TriangleMesh& surface)
    : tree_(surface), sign_(six_volumes(surface, tree_.box().centre()) < 0 ? -1 : 1) {}

double SolidRegion::signed_distance(const Vec3& x, double limit) const {
    const double distance = std::min(tree_.nearest(x, limit).distance, limit);
    const double magnitude = std::max(distance, 1e-300);
    return inside(x) ? -magnitude : magnitude;
}

bool SolidRegion::uniform(const Vec3& x, double radius, bool& is_inside) const {
    if (tree_.nearest(x, radius).triangle >= 0) return false;
    const double winding = sign_ * tree_.winding_number(x, kAccuracy);
    is_inside = winding > 0.5;
    return std::abs(winding - std::round(winding)) < kSettled;
}

double SolidRegion::leaf_fraction(const Vec3& centre, double radius, double side) const {
    const NearestPoint near = tree_.nearest(centre, radius);
    const bool is_inside = inside(centre);
    if (near.triangle < 0) return is_inside ? 1 : 0;  // in or before a hole
    // Where parts overlap, sheets lie inside of the region that do not bound it: a step beyond them is inside too.
    if (near.distance > 0 && inside(near.point + kBeyond * side / near.distance * (near.point - centre)) == is_inside) return is_inside ? 1 : 0;
    return plane_fraction(is_inside ? -near.distance : near.distance, side);
}

double SolidRegion::fraction(const Box& box, int depth) const {
    const Vec3 centre = box.centre(), size = box.size();
    const double radius = 0.5 * size.norm();
    bool is_inside = false;
    if (depth == 0) return leaf_fraction(centre, radius, size.maxCoeff());
    if (uniform(centre, radius, is_inside)) return is_inside ? 1 : 0;
    double sum = 0;
    for (int k = 0; k < 8; ++k) {
        Box part = box;
        for (int axis = 0; axis < 3; ++axis) ((k >> axis & 1) != 0 ? part.min_m : part.max_m)[axis] = centre[axis];
        sum += fraction(part, depth - 1);
    }
    return sum / 8;
}

double SolidRegion::fraction(const std::array<Vec3, 4>& tet, int depth) const {
    const Vec3 centre = 0.25 * (tet[0] + tet[1] + tet[2] + tet[3]);
    double radius = 0;
    for (const Vec3& x : tet) radius = std::max(radius, (x - centre).norm());
    bool is_inside = false;
    if (depth == 0) return leaf_fraction(centre, radius, std::cbrt((tet[1] - tet[0]).cross(tet[2] - tet[0]).dot(tet[3] - tet[0]) / 6));
    if (uniform(centre, radius, is_inside)) return is_inside ? 1 : 0;
    double sum = 0;
    for (const auto& part : kTetParts) {
        std::array<Vec3, 4> small;
        for (std::size_t k = 0; k < 4; ++k) small[k] = 0.5 * (tet[std::size_t(part[k][0])] + tet[std::size_t(part[k][1])]);
        sum += fraction(small, depth - 1);
    }
    return sum / 8;
}

double SolidRegion::volume(Team& team) const {
    // Cells of 1/8 of the mean extent, halved three times. Edges and corners of the surface make an error of second order in the last cells' size, which the
    // difference to cells of twice the size removes.
    constexpr int kDepth = 3;
    constexpr double kCells = 512, kMostAlong = 64;
    const Vec3 size = box().size();
    const double side = std::max(std::cbrt(size.prod() / kCells), size.maxCoeff() / kMostAlong);
    std::array<std::size_t, 3> parts{};
    for (int axis = 0; axis < 3; ++axis) parts[std::size_t(axis)] = std::size_t(std::max(std::ceil(size[axis] / side - 1e-9), 1.0));
    std::vector<double> inside(parts[0] * parts[1] * parts[2]);
    team.for_chunks(inside.size(), [&](std::size_t i) {
        const Vec3 cell(double(i % parts[0]), double(i / parts[0] % parts[1]), double(i / parts[0] / parts[1]));
        Box part;
        part.include(Vec3(box().min_m + side * cell));
        part.include(Vec3(box().min_m + side * (cell + Vec3::Ones())));
        inside[i] = (4 * fraction(part, kDepth) - fraction(part, kDepth - 1)) / 3;
    });
    double sum = 0;
    for (const double f : inside) sum += f;
    return sum * side * side * side;
}

FarSigns::FarSigns(const SolidRegion& region, double margin_m, double block_m, Team& team) : region_(region), block_m_(block_m) {
    const Vec3 size = region.box().size() + Vec3::Constant(2 * margin_m);
    block_m_ = std::max(block_m_, std::cbrt(size.prod() / double(1 << 21)));
    block_m_ = std::max(block_m_, size.maxCoeff() / 1e6);
    origin_ = region.box().min_m - Vec3::Constant(margin_m);
    for (int axis = 0; axis < 3; ++axis) blocks_[std::size_t(axis)] = std::int64_t(size[axis] / block_m_) + 1;
    sign_.assign(std::size_t(blocks_[0] * blocks_[1] * blocks_[2]), 0);
    const double radius = 0.5 * std::sqrt(3.0) * block_m_ * (1 + 1e-9) + margin_m;
    team.for_range(sign_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto n = std::int64_t(i);
            const Vec3 cell(double(n % blocks_[0]), double(n / blocks_[0] % blocks_[1]), double(n / blocks_[0] / blocks_[1]));
            bool is_inside = false;
            if (region.uniform(origin_ + block_m_ * (cell + Vec3::Constant(0.5)), radius, is_inside)) sign_[i] = is_inside ? -1 : 1;
        }
    });
}

int FarSigns::side(const Vec3& x) const {
    const Vec3 cell = (x - origin_) / block_m_;
    std::array<std::int64_t, 3> c{};
    for (int axis = 0; axis < 3; ++axis) {
        if (!(cell[axis] >= 0 && cell[axis] < double(blocks_[std::size_t(axis)]))) return 0;
        c[std::size_t(axis)] = std::int64_t(cell[axis]);
    }
    return sign_[std::size_t(c[0] + blocks_[0] * (c[1] + blocks_[1] * c[2]))];
}

double FarSigns::signed_distance(const Vec3& x, double limit) const {
    const int sign = side(x);
    return sign == 0 ? region_.signed_distance(x, limit) : sign * limit;
}

}  // namespace supple
