#include "supple/contact/distance_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "supple/base/error.h"
#include "supple/mesh/triangle_tree.h"

namespace supple::contact {

namespace {

constexpr double kRim = 2.5;  // cells of the grid beyond the surface on each side
// The grid is shifted by odd parts of a cell, so that its lines do not run along faces and through corners of shapes with round numbers.
constexpr std::array<double, 3> kShift = {0.137, 0.211, 0.173};

[[noreturn]] void bad(const std::string& name, const std::string& message) { throw Error(ErrorCode::invalid_argument, name, message); }

/// Twice the signed area of (a, b, p) seen along `axis`, from the smaller of a and b to the larger: both triangles at an edge get the same bits.
double side(const Vec3& a, const Vec3& b, std::int32_t ia, std::int32_t ib, double u, double v, Eigen::Index U, Eigen::Index V) {
    const Vec3 &p = ia < ib ? a : b, &q = ia < ib ? b : a;
    const double s = (q[U] - p[U]) * (v - p[V]) - (q[V] - p[V]) * (u - p[U]);
    return ia < ib ? s : -s;
}

}  // namespace

void DistanceGrid::weld(std::span<const Vec3> vertices, std::span<const Triangle> triangles, const std::string& name) {
    std::map<std::tuple<double, double, double>, std::int32_t> seen;
    std::vector<std::int32_t> place(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3& p = vertices[i];
        if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 1e6) bad(name, "vertex " + std::to_string(i) + " is not finite, or farther than 1e6 m from the origin");
        const auto [it, fresh] = seen.try_emplace({p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}, std::int32_t(vertices_.size()));
        if (fresh) vertices_.push_back(p);
        place[i] = it->second;
    }
    std::map<std::pair<std::int32_t, std::int32_t>, int> open;  // directed edges less their opposites
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        Triangle welded{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t v = triangles[t][k];
            if (v < 0 || std::size_t(v) >= vertices.size()) bad(name, "triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " + std::to_string(vertices.size()));
            welded[k] = place[std::size_t(v)];
        }
        if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) continue;  // no area, and its edges cancel
        triangles_.push_back(welded);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t a = welded[k], b = welded[(k + 1) % 3];
            open[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    if (triangles_.empty()) bad(name, "has no triangle of any area");
    const auto gaps = std::count_if(open.begin(), open.end(), [](const auto& edge) { return edge.second != 0; });
    if (gaps != 0) {
        bad(name, "the surface is not closed, or its triangles are not wound alike: " + std::to_string(gaps) + " of " + std::to_string(open.size()) +
                      " edges lack their opposite; close it first");
    }
}

/// Volume, centre and inertia by tetrahedra from the origin (sums of signed parts); turns a surface that is inside out.
void DistanceGrid::measure(const std::string& name) {
    bounds_ = {};
    for (const Vec3& p : vertices_) bounds_.include(p);
    const Vec3 from = 0.5 * (bounds_.min_m + bounds_.max_m);
    double volume = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (const Triangle& t : triangles_) {
        const Vec3 a = vertices_[std::size_t(t[0])] - from, b = vertices_[std::size_t(t[1])] - from, c = vertices_[std::size_t(t[2])] - from;
        const double v = a.dot(b.cross(c)) / 6;
        const Vec3 sum = a + b + c;
        volume += v;
        first += v / 4 * sum;
        second += v / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
    if (volume < 0) {
        for (Triangle& t : triangles_) std::swap(t[1], t[2]);
        volume = -volume;
        first = -first;
        second = -second;
    }
    const double box = (bounds_.max_m - bounds_.min_m).norm();
    if (!(volume > 1e-9 * box * box * box)) bad(name, "the surface encloses no volume");
    mass_.volume_m3 = volume;
    const Vec3 centre = first / volume;
    const Mat3 about = second - volume * centre * centre.transpose();
    mass_.centre_m = from + centre;
    mass_.inertia_m5 = about.trace() * Mat3::Identity() - about;
}

void DistanceGrid::fill_distances() {
    const TriangleTree tree({vertices_, triangles_});
    value_.resize(nodes_[0] * nodes_[1] * nodes_[2]);
    for (std::size_t k = 0; k < nodes_[2]; ++k) {
        for (std::size_t j = 0; j < nodes_[1]; ++j) {
            double last = 1e300;
            for (std::size_t i = 0; i < nodes_[0]; ++i) {
                const Vec3 p = origin_ + spacing_ * Vec3(double(i), double(j), double(k));
                // A neighbour's distance bounds this one's.
                last = tree.nearest(p, last + 1.001 * spacing_).distance;
                value_[(k * nodes_[1] + j) * nodes_[0] + i] = float(last);
            }
        }
    }
}

/// Counts along the lines of each axis how often the surface winds around a node; two of three decide.
void DistanceGrid::sign_distances() {
    std::vector<std::uint8_t> votes(value_.size(), 0);
    const auto index = [&](const std::array<std::size_t, 3>& n) { return (n[2] * nodes_[1] + n[1]) * nodes_[0] + n[0]; };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t au = (axis + 1) % 3, av = (axis + 2) % 3;
        const auto A = Eigen::Index(axis), U = Eigen::Index(au), V = Eigen::Index(av);
        std::vector<std::int32_t> step(value_.size(), 0);  // change of the winding number between a node and the one before it on its line
        for (const Triangle& t : triangles_) {
            const std::array<const Vec3*, 3> p = {&vertices_[std::size_t(t[0])], &vertices_[std::size_t(t[1])], &vertices_[std::size_t(t[2])]};
            const auto first_node = [&](double x, Eigen::Index c) { return std::size_t(std::max(0.0, std::ceil((x - origin_[c]) / spacing_))); };
            const auto range = [&](Eigen::Index c, std::size_t n) {
                const double low = std::min({(*p[0])[c], (*p[1])[c], (*p[2])[c]}), high = std::max({(*p[0])[c], (*p[1])[c], (*p[2])[c]});
                return std::pair(first_node(low, c), std::min(n, first_node(high, c) + 1));
            };
            const auto [u0, u1] = range(U, nodes_[au]);
            const auto [v0, v1] = range(V, nodes_[av]);
            for (std::size_t iu = u0; iu < u1; ++iu) {
                for (std::size_t iv = v0; iv < v1; ++iv) {
                    const double u = origin_[U] + spacing_ * double(iu), v = origin_[V] + spacing_ * double(iv);
                    std::array<double, 3> s{};
                    for (std::size_t k = 0; k < 3; ++k) s[k] = side(*p[k], *p[(k + 1) % 3], t[k], t[(k + 1) % 3], u, v, U, V);
                    const bool positive = s[0] > 0 && s[1] > 0 && s[2] > 0, negative = s[0] < 0 && s[1] < 0 && s[2] < 0;
                    if (!positive && !negative) continue;
                    const double sum = s[0] + s[1] + s[2];
                    const double x = (s[1] * (*p[0])[A] + s[2] * (*p[1])[A] + s[0] * (*p[2])[A]) / sum;
                    std::array<std::size_t, 3> n{};
                    n[axis] = first_node(x, A);
                    n[au] = iu;
                    n[av] = iv;
                    if (n[axis] < nodes_[axis]) step[index(n)] += positive ? -1 : 1;
                }
            }
        }
        std::array<std::size_t, 3> n{};
        for (n[au] = 0; n[au] < nodes_[au]; ++n[au]) {
            for (n[av] = 0; n[av] < nodes_[av]; ++n[av]) {
                std::int32_t winding = 0;
                for (n[axis] = 0; n[axis] < nodes_[axis]; ++n[axis]) {
                    winding += step[index(n)];
                    if (winding > 0) ++votes[index(n)];
                }
            }
        }
    }
    for (std::size_t i = 0; i < value_.size(); ++i) {
        if (votes[i] < 2) continue;
        depth_m_ = std::max(depth_m_, double(value_[i]));
        value_[i] = -value_[i];
    }
    depth_m_ = std::max(depth_m_, 0.25 * spacing_);
}

std::shared_ptr<const DistanceGrid> DistanceGrid::build(std::span<const Vec3> vertices, std::span<const Triangle> triangles, const std::string& name, int cells) {
    require_in_range(cells, 8, 256, name + ".cells", "64 is usual");
    std::shared_ptr<DistanceGrid> grid(new DistanceGrid);
    grid->weld(vertices, triangles, name);
    grid->measure(name);
    const Vec3 size = grid->bounds_.max_m - grid->bounds_.min_m;
    grid->spacing_ = size.maxCoeff() / cells;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto axis = Eigen::Index(c);
        grid->origin_[axis] = grid->bounds_.min_m[axis] - (kRim + kShift[c]) * grid->spacing_;
        grid->nodes_[c] = std::size_t(std::ceil(size[axis] / grid->spacing_ + 2 * kRim + 1)) + 1;
    }
    grid->fill_distances();
    grid->sign_distances();
    return grid;
}

Distance DistanceGrid::distance(const Vec3& p) const {
    // The nearest point of the grid, and how far beyond it p is.
    std::array<std::size_t, 3> n{};
    Vec3 f, inside = p;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto axis = Eigen::Index(c);
        const double last = double(nodes_[c] - 1);
        const double place = (p[axis] - origin_[axis]) / spacing_, x = std::clamp(place, 0.0, last);
        if (x != place) inside[axis] = origin_[axis] + spacing_ * x;
        n[c] = std::min(std::size_t(x), nodes_[c] - 2);
        f[axis] = x - double(n[c]);
    }
    double v[2][2][2];
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t j = 0; j < 2; ++j)
            for (std::size_t i = 0; i < 2; ++i) v[k][j][i] = at(n[0] + i, n[1] + j, n[2] + k);
    const auto mix = [](double a, double b, double s) { return a + s * (b - a); };
    double y[2][2], dx[2][2];
    for (int k = 0; k < 2; ++k) {
        for (int j = 0; j < 2; ++j) {
            y[k][j] = mix(v[k][j][0], v[k][j][1], f.x());
            dx[k][j] = v[k][j][1] - v[k][j][0];
        }
    }
    const double z0 = mix(y[0][0], y[0][1], f.y()), z1 = mix(y[1][0], y[1][1], f.y());
    Vec3 gradient(mix(mix(dx[0][0], dx[0][1], f.y()), mix(dx[1][0], dx[1][1], f.y()), f.z()), mix(y[0][1] - y[0][0], y[1][1] - y[1][0], f.z()), z1 - z0);
    Distance result{mix(z0, z1, f.z()), Vec3(0, 1, 0)};
    const Vec3 beyond = p - inside;
    const double outside = beyond.norm();
    if (outside > 0) {  // beyond the grid: no more than the distance, so that sweeps do not overshoot
        const Vec3 way = (bounds_.min_m - p).cwiseMax(p - bounds_.max_m).cwiseMax(0.0);
        result.normal = beyond / outside;
        result.d = std::max(way.norm(), result.d - outside);
        return result;
    }
    const double length = gradient.norm();
    if (length > 0) result.normal = gradient / length;
    return result;
}

}  // namespace supple::contact
