// Trilinear maps: x(xi) = sum_a N_a(xi) X_a on [0, 1]^3 is inverted by Newton's method, with xi held in the cube. A point beyond it gets the linear continuation
// N(xi0) + grad N(xi0) . (x - x(xi0)) from the nearest xi0 that Newton found: sum N_a = 1 and sum N_a X_a = x hold exactly there too, so affine motions are reproduced.
#include "supple/mesh/embedding.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "supple/base/error.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/triangle_tree.h"

namespace supple {
namespace {

constexpr int kNewtonSteps = 40;
constexpr double kInsideTolerance = 1e-9;  // of a weight: points on a face belong to whoever asks first

struct Trilinear {
    std::array<double, 8> value;
    std::array<Vec3, 8> slope;  // by xi
};

Trilinear trilinear(const Vec3& xi) {
    constexpr std::array<std::array<int, 3>, 8> kCorner{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    Trilinear n;
    for (std::size_t a = 0; a < 8; ++a) {
        double f[3], s[3];
        for (std::size_t k = 0; k < 3; ++k) {
            f[k] = kCorner[a][k] != 0 ? xi[Eigen::Index(k)] : 1 - xi[Eigen::Index(k)];
            s[k] = kCorner[a][k] != 0 ? 1 : -1;
        }
        n.value[a] = f[0] * f[1] * f[2];
        n.slope[a] = Vec3(s[0] * f[1] * f[2], f[0] * s[1] * f[2], f[0] * f[1] * s[2]);
    }
    return n;
}

void tet_weights(const VolumeMesh& mesh, const Tet& t, const Vec3& x, std::span<double> weights, Vec3* gradient) {
    const auto X = [&](std::size_t a) -> const Vec3& { return mesh.vertices[std::size_t(t[a])]; };
    Mat3 edges;
    edges << X(1) - X(0), X(2) - X(0), X(3) - X(0);
    const Mat3 inverse = edges.inverse();
    const Vec3 w = inverse * (x - X(0));
    weights[0] = 1 - w.sum();
    for (Eigen::Index a = 0; a < 3; ++a) weights[std::size_t(a) + 1] = w[a];
    if (gradient == nullptr) return;
    for (Eigen::Index a = 0; a < 3; ++a) gradient[a + 1] = inverse.row(a).transpose();
    gradient[0] = -(gradient[1] + gradient[2] + gradient[3]);
}

void hex_weights(const VolumeMesh& mesh, const Hex& h, const Vec3& x, std::span<double> weights, Vec3* gradient) {
    Vec3 xi = Vec3::Constant(0.5), at = Vec3::Zero();
    Trilinear n = trilinear(xi);
    Mat3 jacobian;
    const auto evaluate = [&] {
        n = trilinear(xi);
        at.setZero();
        jacobian.setZero();
        for (std::size_t a = 0; a < 8; ++a) {
            const Vec3& X = mesh.vertices[std::size_t(h[a])];
            at += n.value[a] * X;
            jacobian += X * n.slope[a].transpose();
        }
    };
    evaluate();
    for (int i = 0; i < kNewtonSteps; ++i) {
        const Vec3 next = (xi + jacobian.partialPivLu().solve(x - at)).cwiseMax(0.0).cwiseMin(1.0);
        if (!next.allFinite()) break;
        const double moved = (next - xi).cwiseAbs().maxCoeff();
        xi = next;
        evaluate();
        if (moved < 1e-14) break;
    }
    const Mat3 inverse = jacobian.inverse();
    const Vec3 rest = inverse * (x - at);
    for (std::size_t a = 0; a < 8; ++a) {
        weights[a] = n.value[a] + n.slope[a].dot(rest);
        if (gradient != nullptr) gradient[a] = inverse.transpose() * n.slope[a];
    }
}

}  // namespace

void shape_weights(const VolumeMesh& mesh, std::int32_t element, const Vec3& x, std::span<double> weights, Vec3* gradient) {
    const std::size_t e = std::size_t(element);
    if (e < mesh.tets.size())
        tet_weights(mesh, mesh.tets[e], x, weights, gradient);
    else
        hex_weights(mesh, mesh.hexes[e - mesh.tets.size()], x, weights, gradient);
}

ElementLocator::ElementLocator(const VolumeMesh& mesh) : mesh_(mesh), boxes_(mesh.element_count()) {
    for (std::size_t e = 0; e < boxes_.size(); ++e) {
        for (const std::int32_t v : element_vertices(mesh, e)) boxes_[e].include(mesh.vertices[std::size_t(v)]);
        const Vec3 slack = Vec3::Constant(1e-9 * boxes_[e].size().maxCoeff());  // a point on a face may lie a rounding outside of both boxes
        boxes_[e].min_m -= slack;
        boxes_[e].max_m += slack;
    }
    tree_ = BoxTree(boxes_);
}

std::int32_t ElementLocator::holding(const Vec3& x) const {
    std::int32_t best = -1;
    double best_weight = -kInsideTolerance;
    std::array<double, Embedding::kMaxCorners> w{};
    tree_.at_point(boxes_, x, [&](std::int32_t e) {
        shape_weights(mesh_, e, x, w);
        const auto n = element_vertices(mesh_, e).size();
        const double least = *std::min_element(w.begin(), w.begin() + std::ptrdiff_t(n));
        if (least < best_weight || (least == best_weight && best >= 0 && best < e)) return;
        best_weight = least;
        best = e;
    });
    return best;
}

std::int32_t ElementLocator::nearest(const Vec3& x, double& distance_m) {
    if (!boundary_tree_) {
        boundary_ = extract_boundary(mesh_);
        boundary_tree_.emplace(mesh::TriangleMesh{mesh_.vertices, boundary_.triangles});
    }
    const NearestPoint p = boundary_tree_->nearest(x);
    distance_m = p.distance;
    return boundary_.element[std::size_t(p.triangle)];
}

Embedding::Embedding(const VolumeMesh& mesh, std::span<const Vec3> points) : corners_(mesh.hexes.empty() ? 4 : 8) {
    const auto refuse = [](const std::string& message) { throw Error(ErrorCode::invalid_argument, "Embedding", message); };
    if (mesh.element_count() == 0) refuse("the mesh has no element to embed into");
    ElementLocator locator(mesh);
    element_.resize(points.size());
    vertex_.resize(points.size() * corners_);
    weight_.resize(points.size() * corners_, 0.0);
    gradient_.resize(points.size() * corners_, Vec3::Zero());
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Vec3& x = points[p];
        if (!x.allFinite()) refuse("point " + std::to_string(p) + " is not finite");
        std::int32_t element = locator.holding(x);
        const bool outside = element < 0;
        double distance = 0;
        if (outside) element = locator.nearest(x, distance);
        bind(mesh, p, x, element);
        const std::span<double> w(weight_.data() + p * corners_, corners_);
        if (!outside) continue;
        ++report_.outside;
        report_.farthest_m = std::max(report_.farthest_m, distance);
        const double least = *std::min_element(w.begin(), w.end());
        if (report_.worst_point < 0 || least < report_.least_weight) {
            report_.least_weight = std::min(least, 0.0);
            report_.worst_point = std::int32_t(p);
        }
    }
}

void Embedding::bind(const VolumeMesh& mesh, std::size_t p, const Vec3& x, std::int32_t element) {
    const auto ids = element_vertices(mesh, element);
    shape_weights(mesh, element, x, {weight_.data() + p * corners_, corners_}, gradient_.data() + p * corners_);
    element_[p] = element;
    for (std::size_t a = 0; a < corners_; ++a) vertex_[p * corners_ + a] = ids[a < ids.size() ? a : 0];
}

Embedding Embedding::bound(const VolumeMesh& mesh, std::span<const Vec3> points, std::vector<std::int32_t> elements) {
    Embedding out;
    out.corners_ = mesh.hexes.empty() ? 4 : 8;
    out.element_ = std::move(elements);
    out.vertex_.resize(points.size() * out.corners_);
    out.weight_.resize(points.size() * out.corners_, 0.0);
    out.gradient_.resize(points.size() * out.corners_, Vec3::Zero());
    for (std::size_t p = 0; p < points.size(); ++p) out.bind(mesh, p, points[p], out.element_[p]);
    return out;
}

void Embedding::deform(std::span<const Vec3> positions, std::span<Vec3> out) const {
    for (std::size_t p = 0; p < element_.size(); ++p) {
        Vec3 x = Vec3::Zero();
        for (std::size_t i = p * corners_; i < (p + 1) * corners_; ++i) x += weight_[i] * positions[std::size_t(vertex_[i])];
        out[p] = x;
    }
}

Mat3 Embedding::deformation_gradient(std::size_t point, std::span<const Vec3> positions) const {
    Mat3 F = Mat3::Zero();
    for (std::size_t i = point * corners_; i < (point + 1) * corners_; ++i) F += positions[std::size_t(vertex_[i])] * gradient_[i].transpose();
    return F;
}

void Embedding::deform_normals(std::span<const Vec3> positions, std::span<const Vec3> rest_normals, std::span<Vec3> out) const {
    for (std::size_t p = 0; p < element_.size(); ++p) {
        const Mat3 F = deformation_gradient(p, positions);
        Mat3 cofactor;
        cofactor << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
        const Vec3 n = cofactor * rest_normals[p];
        const double length = n.norm();
        out[p] = length > 0 ? Vec3(n / length) : rest_normals[p];
    }
}

void Embedding::interpolate(std::span<const double> per_vertex, std::span<double> out) const {
    for (std::size_t p = 0; p < element_.size(); ++p) {
        double sum = 0, weight = 0;
        for (std::size_t i = p * corners_; i < (p + 1) * corners_; ++i) {
            const double w = std::max(weight_[i], 0.0);
            weight += w;
            sum += w * per_vertex[std::size_t(vertex_[i])];
        }
        out[p] = sum / weight;  // weights sum to one: some are positive
    }
}

}  // namespace supple
