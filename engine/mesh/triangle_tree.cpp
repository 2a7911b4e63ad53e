// Winding numbers after Barill et al. 2018. With g(r) = r / (4 pi |r|^3), a surface element of area vector A at p adds A . g(p - x). Around the centre c of a
// cluster, with d = p - c and r = c - x:
//   w = sum A_j g_j(r) + sum d_i A_j d_i g_j + 1/2 sum d_i d_k A_j d_i d_k g_j + ...
//   4 pi d_i g_j     = delta_ij / |r|^3 - 3 r_i r_j / |r|^5
//   4 pi d_i d_k g_j = -3 (delta_ij r_k + delta_ik r_j + delta_jk r_i) / |r|^5 + 15 r_i r_j r_k / |r|^7
// Integrated over a triangle of area a: d becomes a times that of the centroid, d d^T becomes a/12 (sum over corners d d^T + s s^T), s the sum of the corners' d. Of the
// third-order tensor T_ikj = 1/2 sum d_i d_k A_j only two contractions matter: the vector 2 T_iki + T_iij . and the cubic form T_ikj r_i r_k r_j, ten numbers.
// Near triangles add their solid angle (van Oosterom and Strackee 1983):
//   tan(angle / 2) = a.(b x c) / (|a||b||c| + a.b |c| + b.c |a| + c.a |b|).
#include "supple/mesh/triangle_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "supple/base/error.h"

namespace supple {
namespace {

constexpr std::int32_t kLeafSize = 4;

/// A sum of half solid angles of triangles, seen from the origin. Each is the argument of a complex number, so their sum is that of the product, with whole turns
/// counted: one arctangent for many triangles.
class SolidAngles {
public:
    void add(const Vec3& a, const Vec3& b, const Vec3& c) {
        const double det = a.dot(b.cross(c));
        if (det == 0) return;  // in its plane, or no triangle: a point of the surface itself belongs to neither side
        const double la = a.norm(), lb = b.norm(), lc = c.norm();
        const double re = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        const double product_re = re_ * re - im_ * det, product_im = re_ * det + im_ * re;
        // Two arguments of one sign whose sum has the other one have passed pi.
        if ((im_ < 0) == (det < 0) && (product_im < 0) != (det < 0)) turns_ += det < 0 ? -1 : 1;
        const double scale = 1 / (std::abs(product_re) + std::abs(product_im));
        re_ = product_re * scale;
        im_ = product_im * scale;
    }

    double sum() const { return std::atan2(im_ == 0 ? 0.0 : im_, re_) + 2 * std::numbers::pi * turns_; }

private:
    double re_ = 1, im_ = 0;  // argument in (-pi, pi]; the magnitude is of no interest
    int turns_ = 0;
};

Vec3 area_vector(const std::array<Vec3, 3>& t) { return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]); }

/// The coefficients of a cubic form sum T_ikj r_i r_k r_j, T symmetric in i and k, and its value.
using Cubic = std::array<double, 10>;  // xxx yyy zzz xxy xxz yyx yyz zzx zzy xyz

void add_cubic(const Mat3& D, const Vec3& A, Cubic& c) {  // T_ikj = D_ik A_j
    for (int i = 0; i < 3; ++i) {
        c[std::size_t(i)] += D(i, i) * A[i];
        const int j = i == 0 ? 1 : 0, k = i == 2 ? 1 : 2;  // the two others, ascending
        c[std::size_t(3 + 2 * i)] += D(i, i) * A[j] + 2 * D(i, j) * A[i];
        c[std::size_t(4 + 2 * i)] += D(i, i) * A[k] + 2 * D(i, k) * A[i];
    }
    c[9] += 2 * (D(0, 1) * A[2] + D(1, 2) * A[0] + D(2, 0) * A[1]);
}

double cubic(const Cubic& c, const Vec3& r) {
    const double x = r[0], y = r[1], z = r[2];
    return x * x * (c[0] * x + c[3] * y + c[4] * z) + y * y * (c[1] * y + c[5] * x + c[6] * z) + z * z * (c[2] * z + c[7] * x + c[8] * y) + c[9] * x * y * z;
}

}  // namespace

TriangleTree::Cluster TriangleTree::make_cluster(std::span<const Corners> triangles, const Box& box) {
    Cluster cluster;
    double size = 0;
    Vec3 weighted = Vec3::Zero();
    for (const Corners& t : triangles) {
        const Vec3 A = area_vector(t);
        const double a = A.norm();
        cluster.area += A;
        size += a;
        weighted += a * (t[0] + t[1] + t[2]) / 3;
    }
    cluster.centre = size > 0 ? Vec3(weighted / size) : box.centre();
    double radius2 = 0;
    for (const Corners& t : triangles) {
        const Vec3 A = area_vector(t);
        Vec3 sum = Vec3::Zero();
        Mat3 D = Mat3::Zero();  // 1/2 mean of d d^T
        for (const Vec3& x : t) {
            const Vec3 d = x - cluster.centre;
            radius2 = std::max(radius2, d.squaredNorm());
            sum += d;
            D += d * d.transpose();
        }
        D = (D + sum * sum.transpose()) / 24;
        cluster.moment += sum / 3 * A.transpose();
        cluster.vector += 2 * D * A + D.trace() * A;
        add_cubic(D, A, cluster.cubic);
    }
    cluster.radius = std::sqrt(radius2);
    return cluster;
}

NearestPoint nearest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
    NearestPoint best;
    const auto take = [&](double u, double v, double w) {
        const Vec3 p = u * a + v * b + w * c;
        const double d = (p - x).norm();
        if (d < best.distance) best = {0, {u, v, w}, p, d};
    };
    const Vec3 ab = b - a, ac = c - a, n = ab.cross(ac);
    const double area = n.squaredNorm();
    if (area > 0) {
        const Vec3 ax = x - a;
        const double v = ax.cross(ac).dot(n) / area, w = ab.cross(ax).dot(n) / area;
        if (v >= 0 && w >= 0 && v + w <= 1) {
            take(1 - v - w, v, w);
            return best;
        }
    }
    const auto along = [&](const Vec3& p, const Vec3& q) {
        const Vec3 d = q - p;
        const double l2 = d.squaredNorm();
        return l2 > 0 ? std::clamp((x - p).dot(d) / l2, 0.0, 1.0) : 0.0;
    };
    double t = along(a, b);
    take(1 - t, t, 0);
    t = along(b, c);
    take(0, 1 - t, t);
    t = along(c, a);
    take(t, 0, 1 - t);
    return best;
}

TriangleTree::TriangleTree(const mesh::TriangleMesh& surface) {
    const auto refuse = [](const std::string& message) { throw Error(ErrorCode::invalid_argument, "TriangleTree", message); };
    if (surface.triangles.empty()) refuse("the surface has no triangle");
    const auto count = static_cast<std::int64_t>(surface.vertices.size());
    std::vector<Box> boxes(surface.triangles.size());
    for (std::size_t t = 0; t < boxes.size(); ++t)
        for (const int v : surface.triangles[t]) {
            if (v < 0 || v >= count)
                refuse("triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " + std::to_string(count));
            const Vec3& x = surface.vertices[std::size_t(v)];
            if (!x.allFinite()) refuse("vertex " + std::to_string(v) + " is not finite");
            boxes[t].include(x);
        }
    tree_ = BoxTree(boxes, kLeafSize);
    corners_.reserve(boxes.size());
    for (const std::int32_t t : tree_.order()) {
        const auto& v = surface.triangles[std::size_t(t)];
        corners_.push_back({surface.vertices[std::size_t(v[0])], surface.vertices[std::size_t(v[1])], surface.vertices[std::size_t(v[2])]});
    }
    build_clusters();
}

void TriangleTree::build_clusters() {
    const auto nodes = tree_.nodes();
    clusters_.resize(nodes.size());
    std::vector<std::int32_t> first(nodes.size()), end(nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;) {  // children before their parent
        const BoxTree::Node& node = nodes[i];
        first[i] = node.leaf() ? node.first : first[i + 1];
        end[i] = node.leaf() ? node.first + node.count : end[std::size_t(node.right)];
        clusters_[i] = make_cluster(std::span(corners_).subspan(std::size_t(first[i]), std::size_t(end[i] - first[i])), node.box);
    }
}

NearestPoint TriangleTree::nearest(const Vec3& x, double limit) const {
    const auto nodes = tree_.nodes();
    NearestPoint best;
    best.distance = limit;
    double best2 = limit * limit;
    struct Entry {
        std::int32_t node;
        double distance2;
    };
    std::array<Entry, BoxTree::kMaxDepth> stack;
    int top = 0;
    stack[0] = {0, nodes[0].box.squared_distance(x)};
    for (top = 1; top > 0;) {
        const Entry entry = stack[std::size_t(--top)];
        if (entry.distance2 > best2) continue;
        const BoxTree::Node& node = nodes[std::size_t(entry.node)];
        if (node.leaf()) {
            for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
                const Corners& t = corners_[std::size_t(k)];
                const NearestPoint p = nearest_on_triangle(x, t[0], t[1], t[2]);
                if (p.distance > best.distance || (p.distance == best.distance && best.triangle >= 0)) continue;
                best = p;
                best.triangle = tree_.order()[std::size_t(k)];
                best2 = p.distance * p.distance;
            }
            continue;
        }
        Entry near{entry.node + 1, nodes[std::size_t(entry.node) + 1].box.squared_distance(x)};
        Entry far{node.right, nodes[std::size_t(node.right)].box.squared_distance(x)};
        if (far.distance2 < near.distance2) std::swap(near, far);
        if (far.distance2 <= best2) stack[std::size_t(top++)] = far;
        if (near.distance2 <= best2) stack[std::size_t(top++)] = near;
    }
    if (best.triangle < 0) best.distance = std::numeric_limits<double>::infinity();
    return best;
}

double TriangleTree::winding_number(const Vec3& x, double accuracy) const {
    const auto nodes = tree_.nodes();
    double far = 0;
    SolidAngles near;
    std::array<std::int32_t, BoxTree::kMaxDepth> stack;
    int top = 0;
    stack[0] = 0;
    for (top = 1; top > 0;) {
        const std::int32_t i = stack[std::size_t(--top)];
        const Cluster& cluster = clusters_[std::size_t(i)];
        const Vec3 r = cluster.centre - x;
        const double r2 = r.squaredNorm(), reach = accuracy * cluster.radius;
        if (r2 > reach * reach) {
            const double inverse2 = 1 / r2, inverse3 = inverse2 * std::sqrt(inverse2);
            far += inverse3 * (cluster.area.dot(r) + cluster.moment.trace() -
                               3 * inverse2 * (r.dot(cluster.moment * r) + cluster.vector.dot(r) - 5 * inverse2 * cubic(cluster.cubic, r)));
            continue;
        }
        const BoxTree::Node& node = nodes[std::size_t(i)];
        if (node.leaf()) {
            for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
                const Corners& t = corners_[std::size_t(k)];
                near.add(t[0] - x, t[1] - x, t[2] - x);
            }
        } else {
            stack[std::size_t(top++)] = node.right;
            stack[std::size_t(top++)] = i + 1;
        }
    }
    return (0.5 * far + near.sum()) * 0.5 * std::numbers::inv_pi;
}

double TriangleTree::exact_winding_number(const Vec3& x) const {
    SolidAngles angles;
    for (const Corners& t : corners_) angles.add(t[0] - x, t[1] - x, t[2] - x);
    return 0.5 * std::numbers::inv_pi * angles.sum();
}

std::optional<RayHit> TriangleTree::first_hit(const Ray& ray) const {
    const auto nodes = tree_.nodes();
    const Vec3 inverse = ray.direction.cwiseInverse();
    double nearest = std::numeric_limits<double>::infinity();
    const auto enters = [&](const Box& box) {
        double begin = 0, end = nearest;
        for (int k = 0; k < 3; ++k) {
            if (ray.direction[k] == 0) {
                if (ray.origin[k] < box.min_m[k] || ray.origin[k] > box.max_m[k]) return std::numeric_limits<double>::infinity();
                continue;
            }
            double t0 = (box.min_m[k] - ray.origin[k]) * inverse[k], t1 = (box.max_m[k] - ray.origin[k]) * inverse[k];
            if (t0 > t1) std::swap(t0, t1);
            begin = std::max(begin, t0 * (1 - 4e-16));
            end = std::min(end, t1 * (1 + 4e-16));
        }
        return begin <= end ? begin : std::numeric_limits<double>::infinity();
    };
    constexpr std::array<Triangle, 1> kAlone{{{0, 1, 2}}};
    std::optional<RayHit> best;
    std::array<std::int32_t, BoxTree::kMaxDepth> stack;
    int top = 0;
    stack[0] = 0;
    for (top = 1; top > 0;) {
        const std::int32_t i = stack[std::size_t(--top)];
        const BoxTree::Node& node = nodes[std::size_t(i)];
        if (std::isinf(enters(node.box))) continue;
        if (node.leaf()) {
            for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
                auto hit = intersect(ray, kAlone, corners_[std::size_t(k)]);
                if (!hit || hit->distance > nearest) continue;
                hit->triangle = tree_.order()[std::size_t(k)];
                if (best && hit->distance == nearest && best->triangle < hit->triangle) continue;
                nearest = hit->distance;
                best = hit;
            }
            continue;
        }
        const bool left_first = enters(nodes[std::size_t(i) + 1].box) <= enters(nodes[std::size_t(node.right)].box);
        stack[std::size_t(top++)] = left_first ? node.right : i + 1;
        stack[std::size_t(top++)] = left_first ? i + 1 : node.right;
    }
    return best;
}

}  // namespace supple
