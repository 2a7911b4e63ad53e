// The line in which two triangles cross begins and ends where an edge of one goes through the other, or where a vertex of one lies on the other. Each such point is found from the
// edge in a fixed direction, so that all triangles at it get the same bits; what lies within the tolerance is then made one point. So it needs no exact arithmetic: where two
// computations disagree whether a line passes a vertex on the left or on the right, both answers are that vertex.
#include "supple/mesh/surface_crossing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>

#include "supple/base/disjoint_sets.h"
#include "supple/mesh/box_tree.h"
#include "supple/mesh/planar_split.h"
#include "supple/mesh/triangle_tree.h"

namespace supple::mesh {

namespace {

constexpr double kParallel = 1e-7;  // sine of an angle: triangles at a smaller one touch, they do not cross

struct Corners {
    std::array<Vec3, 3> x;
    Vec3 normal;  ///< unit; zero for a triangle that is a line
    double distance(const Vec3& p) const { return nearest_on_triangle(p, x[0], x[1], x[2]).distance; }
    double height(const Vec3& p) const { return normal.dot(p - x[0]); }
};

Corners corners_of(const TriangleMesh& surface, std::int32_t triangle) {
    const Triangle& t = surface.triangles[std::size_t(triangle)];
    Corners c{{surface.vertices[std::size_t(t[0])], surface.vertices[std::size_t(t[1])], surface.vertices[std::size_t(t[2])]}, {}};
    c.normal = (c.x[1] - c.x[0]).cross(c.x[2] - c.x[0]);
    const double length = c.normal.norm();
    c.normal = length > 0 ? Vec3(c.normal / length) : Vec3(Vec3::Zero());
    return c;
}

/// A crossing of two triangles, before points are made one.
struct Meeting {
    std::int32_t first, second;
    std::vector<std::int32_t> points;
};

class Crosser {
public:
    Crosser(const TriangleMesh& first, const TriangleMesh& second, double tolerance) : first_(first), second_(second), tolerance_(tolerance) {
        points_ = first.vertices;
        points_.insert(points_.end(), second.vertices.begin(), second.vertices.end());
    }

    CrossedSurfaces run(std::span<const std::int32_t> chosen) {
        find(chosen);
        merge();
        CrossedSurfaces out;
        on_first_.resize(first_.triangles.size());
        on_second_.resize(second_.triangles.size());
        for (const Meeting& m : meetings_) {
            for (const std::int32_t p : m.points) {
                on_first_[std::size_t(m.first)].push_back(p);
                on_second_[std::size_t(m.second)].push_back(p);
            }
            for (std::size_t k = 0; k + 1 < m.points.size(); ++k) out.lines[std::minmax(m.points[k], m.points[k + 1])].push_back({m.first, m.second});
        }
        for (const auto& [line, pairs] : out.lines) {
            for (const auto& pair : pairs) {
                lines_on_first_[pair[0]].push_back({line.first, line.second});
                lines_on_second_[pair[1]].push_back({line.first, line.second});
            }
        }
        std::vector<std::int32_t> all(second_.triangles.size());
        std::iota(all.begin(), all.end(), 0);
        split(first_, 0, chosen, on_first_, lines_on_first_, out.first);
        split(second_, std::int32_t(first_.vertices.size()), all, on_second_, lines_on_second_, out.second);
        for (std::size_t v = 0; v < second_.vertices.size(); ++v) out.second_vertex.push_back(root(std::int32_t(first_.vertices.size() + v)));
        out.point = std::move(points_);
        return out;
    }

private:
    std::int32_t root(std::int32_t p) { return std::int32_t(same_.root(std::size_t(p))); }

    /// Where an edge of `from` goes through a triangle of the other surface.
    void edges_through(const TriangleMesh& from, std::int32_t offset, std::int32_t triangle, const Corners& other, std::int32_t other_id, std::vector<std::int32_t>& found) {
        const Triangle& t = from.triangles[std::size_t(triangle)];
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
            const Vec3 &a = from.vertices[std::size_t(low)], &b = from.vertices[std::size_t(high)];
            const double da = other.height(a), db = other.height(b);
            if (!(da * db < 0)) continue;
            const Vec3 x = a + da / (da - db) * (b - a);
            if (other.distance(x) > tolerance_) continue;
            const auto [known, is_new] = through_.try_emplace({offset + low, offset + high, other_id}, std::int32_t(points_.size()));
            if (is_new) points_.push_back(x);
            found.push_back(known->second);
        }
    }

    void find(std::span<const std::int32_t> chosen) {
        std::vector<Box> boxes;
        std::vector<Corners> corners;
        for (std::size_t c = 0; c < second_.triangles.size(); ++c) {
            corners.push_back(corners_of(second_, std::int32_t(c)));
            boxes.emplace_back();
            for (const Vec3& x : corners.back().x) boxes.back().include(x);
            boxes.back().grow(tolerance_);
        }
        const BoxTree tree(boxes);
        const auto offset = std::int32_t(first_.vertices.size());
        for (const std::int32_t t : chosen) {
            const Corners T = corners_of(first_, t);
            Box box;
            for (const Vec3& x : T.x) box.include(x);
            std::vector<std::int32_t> near;
            tree.overlapping(boxes, box, [&](std::int32_t c) { near.push_back(c); });
            std::sort(near.begin(), near.end());
            for (const std::int32_t c : near) {
                const Corners& C = corners[std::size_t(c)];
                Meeting m{t, c, {}};
                for (std::size_t k = 0; k < 3; ++k) {
                    if (C.distance(T.x[k]) <= tolerance_) m.points.push_back(first_.triangles[std::size_t(t)][k]);
                    if (T.distance(C.x[k]) <= tolerance_) m.points.push_back(offset + second_.triangles[std::size_t(c)][k]);
                }
                edges_through(first_, 0, t, C, c, m.points);
                edges_through(second_, offset, c, T, -1 - t, m.points);
                const Vec3 along = T.normal.cross(C.normal);
                if (m.points.empty() || along.norm() < kParallel) continue;
                along_.push_back(along.normalized());
                meetings_.push_back(std::move(m));
            }
        }
    }

    /// One number for what lies at one place; points of meetings in the order of their lines.
    void merge() {
        same_.reset(points_.size());
        std::vector<std::int32_t> used;
        for (const Meeting& m : meetings_) used.insert(used.end(), m.points.begin(), m.points.end());
        const auto before = [&](std::int32_t a, std::int32_t b) {
            const double x = points_[std::size_t(a)].x(), y = points_[std::size_t(b)].x();
            return x != y ? x < y : a < b;
        };
        std::sort(used.begin(), used.end(), before);
        used.erase(std::unique(used.begin(), used.end()), used.end());
        for (std::size_t i = 0; i < used.size(); ++i) {
            const Vec3& x = points_[std::size_t(used[i])];
            for (std::size_t j = i + 1; j < used.size() && points_[std::size_t(used[j])].x() - x.x() <= tolerance_; ++j)
                if ((points_[std::size_t(used[j])] - x).norm() <= tolerance_) same_.join(std::size_t(used[i]), std::size_t(used[j]));
        }
        for (std::size_t i = 0; i < meetings_.size(); ++i) {
            std::vector<std::int32_t>& points = meetings_[i].points;
            for (std::int32_t& p : points) p = root(p);
            std::sort(points.begin(), points.end());
            points.erase(std::unique(points.begin(), points.end()), points.end());
            std::sort(points.begin(), points.end(), [&](std::int32_t a, std::int32_t b) {
                const double s = along_[i].dot(points_[std::size_t(a)]), t = along_[i].dot(points_[std::size_t(b)]);
                return s != t ? s < t : a < b;
            });
        }
    }

    using Lines = std::map<std::int32_t, std::vector<std::array<std::int32_t, 2>>>;

    /// Parts of some triangles of a surface. Neighbours agree on the points of their common edge.
    void split(const TriangleMesh& surface, std::int32_t offset, std::span<const std::int32_t> chosen, std::vector<std::vector<std::int32_t>>& on, Lines& lines, std::vector<CrossedSurfaces::Part>& out) {
        std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::pair<double, std::int32_t>>> on_edge;  // [edge by roots] points, from the first end
        const auto corner = [&](std::int32_t t, std::size_t k) { return root(offset + surface.triangles[std::size_t(t)][k % 3]); };
        for (const std::int32_t t : chosen) {
            std::vector<std::int32_t>& points = on[std::size_t(t)];
            std::sort(points.begin(), points.end());
            points.erase(std::unique(points.begin(), points.end()), points.end());
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [a, b] = std::minmax({corner(t, k), corner(t, k + 1)});
                const Vec3 &A = points_[std::size_t(a)], edge = points_[std::size_t(b)] - A;
                for (const std::int32_t p : points) {
                    if (p == a || p == b || p == corner(t, k + 2)) continue;
                    const double s = edge.dot(points_[std::size_t(p)] - A) / edge.squaredNorm();
                    if (s > 0 && s < 1 && (points_[std::size_t(p)] - A - s * edge).norm() <= 2 * tolerance_) on_edge[{a, b}].emplace_back(s, p);
                }
            }
        }
        for (auto& [edge, points] : on_edge) {
            std::sort(points.begin(), points.end());
            points.erase(std::unique(points.begin(), points.end()), points.end());
        }
        for (const std::int32_t t : chosen) {
            const std::array<std::int32_t, 3> c{corner(t, 0), corner(t, 1), corner(t, 2)};
            if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
            std::vector<std::int32_t> number(c.begin(), c.end());  // [here] point
            std::array<std::vector<std::int32_t>, 3> edges;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t a = c[k], b = c[(k + 1) % 3];
                const auto found = on_edge.find(std::minmax(a, b));
                if (found == on_edge.end()) continue;
                for (const auto& [s, p] : found->second) {
                    edges[k].push_back(std::int32_t(number.size()));
                    number.push_back(p);
                }
                if (a > b) std::reverse(edges[k].begin(), edges[k].end());
            }
            std::vector<std::int32_t> inside;
            for (const std::int32_t p : on[std::size_t(t)]) {
                if (std::find(number.begin(), number.end(), p) != number.end()) continue;
                inside.push_back(std::int32_t(number.size()));
                number.push_back(p);
            }
            const Corners T{{points_[std::size_t(c[0])], points_[std::size_t(c[1])], points_[std::size_t(c[2])]}, {}};
            const Vec3 u = (T.x[1] - T.x[0]).normalized(), v = ((T.x[1] - T.x[0]).cross(T.x[2] - T.x[0])).cross(u).normalized();
            std::vector<Eigen::Vector2d> plane;
            for (const std::int32_t p : number) plane.emplace_back(u.dot(points_[std::size_t(p)] - T.x[0]), v.dot(points_[std::size_t(p)] - T.x[0]));
            std::vector<std::array<std::int32_t, 2>> segments;
            for (const auto& line : lines[t]) {
                const auto a = std::find(number.begin(), number.end(), line[0]), b = std::find(number.begin(), number.end(), line[1]);
                if (a != number.end() && b != number.end()) segments.push_back({std::int32_t(a - number.begin()), std::int32_t(b - number.begin())});
            }
            for (const auto& part : split_triangle(plane, edges, inside, segments)) out.push_back({{number[std::size_t(part[0])], number[std::size_t(part[1])], number[std::size_t(part[2])]}, t});
        }
    }

    const TriangleMesh &first_, &second_;
    double tolerance_;
    std::vector<Vec3> points_;
    std::map<std::array<std::int32_t, 3>, std::int32_t> through_;
    std::vector<Meeting> meetings_;
    std::vector<Vec3> along_;  ///< [meeting]
    DisjointSets same_;
    std::vector<std::vector<std::int32_t>> on_first_, on_second_;
    Lines lines_on_first_, lines_on_second_;
};

}  // namespace

CrossedSurfaces cross_surfaces(const TriangleMesh& first, std::span<const std::int32_t> chosen, const TriangleMesh& second, double tolerance) {
    return Crosser(first, second, tolerance).run(chosen);
}

}  // namespace supple::mesh
