// Points are inserted one by one, segments recovered by flips of the edges that cross them (Sloan 1993), then all other edges flipped until they are Delaunay's. Triangles that are
// cut by a surface have some points each, so a list without neighbours is enough.
#include "supple/mesh/planar_split.h"

#include <algorithm>

namespace supple::mesh {

namespace {

constexpr double kFlat = 1e-12;  // of the square of its longest edge: a triangle of less area is a line

class Splitter {
public:
    using Tri = std::array<std::int32_t, 3>;
    explicit Splitter(std::span<const Eigen::Vector2d> points) : x_(points), triangles_{{0, 1, 2}} {}

    void insert_on_edge(std::int32_t a, std::int32_t b, std::int32_t p) {
        const auto at = directed(a, b);
        if (at.first < 0) return;
        const std::int32_t c = triangles_[std::size_t(at.first)][std::size_t(at.second + 2) % 3];
        triangles_[std::size_t(at.first)] = {a, p, c};
        triangles_.push_back({p, b, c});
    }

    void insert_inside(std::int32_t p) {
        double best = -1e300;
        std::size_t t = 0, k = 0;
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            double least = 1e300;
            std::size_t edge = 0;
            for (std::size_t e = 0; e < 3; ++e) {
                const double s = height(triangles_[i][e], triangles_[i][(e + 1) % 3], p);
                if (s < least) {
                    least = s;
                    edge = e;
                }
            }
            if (least > best) {
                best = least;
                t = i;
                k = edge;
            }
        }
        const Tri old = triangles_[t];
        const std::int32_t a = old[k], b = old[(k + 1) % 3], c = old[(k + 2) % 3];
        const auto other = directed(b, a);
        if (other.first >= 0 && best <= 1e-9 * (x(b) - x(a)).norm()) {  // on the edge between two
            const std::int32_t d = triangles_[std::size_t(other.first)][std::size_t(other.second + 2) % 3];
            triangles_[t] = {a, p, c};
            triangles_.push_back({p, b, c});
            triangles_[std::size_t(other.first)] = {b, p, d};
            triangles_.push_back({p, a, d});
            return;
        }
        triangles_[t] = {a, b, p};
        triangles_.push_back({b, c, p});
        triangles_.push_back({c, a, p});
    }

    void recover(std::int32_t s, std::int32_t e) {
        for (std::size_t turn = 0; turn < 20 + 4 * triangles_.size() * triangles_.size() && !has(s, e); ++turn) {
            bool flipped = false;
            for (std::size_t i = 0; i < triangles_.size() && !flipped; ++i) {
                for (std::size_t k = 0; k < 3 && !flipped; ++k) {
                    const std::int32_t a = triangles_[i][k], b = triangles_[i][(k + 1) % 3];
                    if (a == s || a == e || b == s || b == e || is_fixed(a, b)) continue;
                    if (!(area(s, e, a) * area(s, e, b) < 0 && area(a, b, s) * area(a, b, e) < 0)) continue;
                    // Of several that cross, each in its turn: the first alone may be flipped to and fro.
                    if ((turn + i) % 2 == 0 || !crossed_elsewhere(s, e, i)) flipped = flip(i, k);
                }
            }
            if (!flipped && turn > 2 * triangles_.size()) break;
        }
        if (has(s, e)) fixed_.push_back(std::minmax(s, e));
    }

    void improve() {
        for (std::size_t turn = 0; turn < 4 * triangles_.size() + 8; ++turn) {
            bool any = false;
            for (std::size_t i = 0; i < triangles_.size(); ++i)
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::int32_t a = triangles_[i][k], b = triangles_[i][(k + 1) % 3], c = triangles_[i][(k + 2) % 3];
                    const auto other = directed(b, a);
                    if (a > b || other.first < 0 || is_fixed(a, b)) continue;
                    const std::int32_t d = triangles_[std::size_t(other.first)][std::size_t(other.second + 2) % 3];
                    if (std::min(quality(a, b, c), quality(b, a, d)) + 1e-9 < std::min(quality(a, d, c), quality(d, b, c))) any = flip(i, k) || any;
                }
            if (!any) return;
        }
    }

    std::vector<Tri> take() { return std::move(triangles_); }

private:
    const Eigen::Vector2d& x(std::int32_t p) const { return x_[std::size_t(p)]; }
    double area(std::int32_t a, std::int32_t b, std::int32_t c) const {  ///< twice
        const Eigen::Vector2d u = x(b) - x(a), v = x(c) - x(a);
        return u.x() * v.y() - u.y() * v.x();
    }
    double height(std::int32_t a, std::int32_t b, std::int32_t p) const { return area(a, b, p) / std::max((x(b) - x(a)).norm(), 1e-300); }
    double quality(std::int32_t a, std::int32_t b, std::int32_t c) const {
        return area(a, b, c) / std::max((x(b) - x(a)).squaredNorm() + (x(c) - x(b)).squaredNorm() + (x(a) - x(c)).squaredNorm(), 1e-300);
    }
    std::pair<std::int32_t, std::int32_t> directed(std::int32_t a, std::int32_t b) const {
        for (std::size_t i = 0; i < triangles_.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                if (triangles_[i][k] == a && triangles_[i][(k + 1) % 3] == b) return {std::int32_t(i), std::int32_t(k)};
        return {-1, -1};
    }
    bool has(std::int32_t a, std::int32_t b) const { return directed(a, b).first >= 0 || directed(b, a).first >= 0; }
    bool is_fixed(std::int32_t a, std::int32_t b) const {
        return std::find(fixed_.begin(), fixed_.end(), std::pair<std::int32_t, std::int32_t>(std::minmax(a, b))) != fixed_.end();
    }
    bool crossed_elsewhere(std::int32_t s, std::int32_t e, std::size_t but) const {
        for (std::size_t i = but + 1; i < triangles_.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t a = triangles_[i][k], b = triangles_[i][(k + 1) % 3];
                if (a != s && a != e && b != s && b != e && area(s, e, a) * area(s, e, b) < 0 && area(a, b, s) * area(a, b, e) < 0) return true;
            }
        return false;
    }
    /// The other diagonal of the two triangles at edge k of triangle i, where they are convex.
    bool flip(std::size_t i, std::size_t k) {
        const std::int32_t a = triangles_[i][k], b = triangles_[i][(k + 1) % 3], c = triangles_[i][(k + 2) % 3];
        const auto other = directed(b, a);
        if (other.first < 0) return false;
        const std::int32_t d = triangles_[std::size_t(other.first)][std::size_t(other.second + 2) % 3];
        const double least = kFlat * std::max((x(b) - x(a)).squaredNorm(), (x(d) - x(c)).squaredNorm());
        if (!(area(a, d, c) > least && area(d, b, c) > least)) return false;
        triangles_[i] = {a, d, c};
        triangles_[std::size_t(other.first)] = {d, b, c};
        return true;
    }

    std::span<const Eigen::Vector2d> x_;
    std::vector<Tri> triangles_;
    std::vector<std::pair<std::int32_t, std::int32_t>> fixed_;
};

}  // namespace

std::vector<std::array<std::int32_t, 3>> split_triangle(std::span<const Eigen::Vector2d> points, const std::array<std::vector<std::int32_t>, 3>& on_edge, std::span<const std::int32_t> inside,
                                                        std::span<const std::array<std::int32_t, 2>> segments) {
    Splitter splitter(points);
    for (std::int32_t k = 0; k < 3; ++k) {
        std::int32_t from = k;
        for (const std::int32_t p : on_edge[std::size_t(k)]) {
            splitter.insert_on_edge(from, (k + 1) % 3, p);
            from = p;
        }
    }
    for (const std::int32_t p : inside) splitter.insert_inside(p);
    for (const auto& s : segments) splitter.recover(s[0], s[1]);
    splitter.improve();
    return splitter.take();
}

}  // namespace supple::mesh
