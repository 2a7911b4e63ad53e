#include "quadrature.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "supple/mesh/topology.h"

namespace supple::verify {
namespace {

/// Barycentric points of a tetrahedron; weights sum to one.
struct TetPoint {
    double weight;
    std::array<double, 4> N;
};

std::vector<TetPoint> tet_rule(bool fine) {
    std::vector<TetPoint> rule;
    const auto four = [&](double weight, double a) {
        for (std::size_t k = 0; k < 4; ++k) {
            rule.push_back({weight, {a, a, a, a}});
            rule.back().N[k] = 1 - 3 * a;
        }
    };
    if (!fine) {
        four(0.25, (5 - std::sqrt(5.0)) / 20);
        return rule;
    }
    // Degree 5 with 14 points (Walkington 2000).
    four(0.07349304311636194934, 0.0927352503108912264);
    four(0.11268792571801585080, 0.3108859192633006098);
    const double c = 0.0455037041256496495;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) {
            rule.push_back({0.04254602077708146644, {c, c, c, c}});
            rule.back().N[i] = rule.back().N[j] = 0.5 - c;
        }
    }
    return rule;
}

/// Gauss points on [0, 1].
std::vector<std::array<double, 2>> line_rule(bool fine) {
    const double a = std::sqrt(1.0 / 3) / 2, b = std::sqrt(0.6) / 2;
    if (!fine) return {{0.5 - a, 0.5}, {0.5 + a, 0.5}};
    return {{0.5 - b, 5.0 / 18}, {0.5, 4.0 / 9}, {0.5 + b, 5.0 / 18}};
}

constexpr std::array<std::array<int, 3>, 8> kHexCorner{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

void tet_points(const VolumeMesh& mesh, bool fine, const std::function<void(const Point&)>& visit) {
    const auto rule = tet_rule(fine);
    for (const Tet& tet : mesh.tets) {
        std::array<Vec3, 4> x;
        for (std::size_t a = 0; a < 4; ++a) x[a] = mesh.vertices[std::size_t(tet[a])];
        Mat3 D;
        D << x[1] - x[0], x[2] - x[0], x[3] - x[0];
        const Mat3 inverse = D.inverse();
        Point p;
        p.vertex = tet;
        for (std::size_t a = 1; a < 4; ++a) p.gradient[a] = inverse.row(Eigen::Index(a - 1));
        p.gradient[0] = -p.gradient[1] - p.gradient[2] - p.gradient[3];
        for (const TetPoint& q : rule) {
            p.weight = q.weight * D.determinant() / 6;
            p.X = Vec3::Zero();
            for (std::size_t a = 0; a < 4; ++a) {
                p.N[a] = q.N[a];
                p.X += q.N[a] * x[a];
            }
            visit(p);
        }
    }
}

void hex_point(const VolumeMesh& mesh, const Hex& hex, const Vec3& s, double weight, const std::function<void(const Point&)>& visit) {
    Point p;
    p.vertex = hex;
    std::array<Vec3, 8> dN;
    Mat3 D = Mat3::Zero();
    for (std::size_t a = 0; a < 8; ++a) {
        Vec3 f, df;
        for (int k = 0; k < 3; ++k) {
            f[k] = kHexCorner[a][std::size_t(k)] ? s[k] : 1 - s[k];
            df[k] = kHexCorner[a][std::size_t(k)] ? 1 : -1;
        }
        p.N[a] = f.prod();
        dN[a] = Vec3(df[0] * f[1] * f[2], f[0] * df[1] * f[2], f[0] * f[1] * df[2]);
        const Vec3& x = mesh.vertices[std::size_t(hex[a])];
        p.X += p.N[a] * x;
        D += x * dN[a].transpose();
    }
    const Mat3 inverse_transpose = D.inverse().transpose();
    for (std::size_t a = 0; a < 8; ++a) p.gradient[a] = inverse_transpose * dN[a];
    p.weight = weight * D.determinant();
    visit(p);
}

void triangle_points(const std::array<Vec3, 3>& x, Point& p, const std::function<void(const Point&)>& visit) {
    const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]);
    p.normal = n.normalized();
    for (const auto& [s, ws] : line_rule(true)) {
        for (const auto& [t, wt] : line_rule(true)) {  // a square folded to the triangle
            p.N = {1 - s, s * (1 - t), s * t};
            p.weight = ws * wt * s * n.norm();
            p.X = p.N[0] * x[0] + p.N[1] * x[1] + p.N[2] * x[2];
            visit(p);
        }
    }
}

void quad_points(const std::array<Vec3, 4>& x, Point& p, const std::function<void(const Point&)>& visit) {
    for (const auto& [s, ws] : line_rule(true)) {
        for (const auto& [t, wt] : line_rule(true)) {
            p.N = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
            const Vec3 n = ((1 - t) * (x[1] - x[0]) + t * (x[2] - x[3])).cross((1 - s) * (x[3] - x[0]) + s * (x[2] - x[1]));
            p.normal = n.normalized();
            p.weight = ws * wt * n.norm();
            p.X = p.N[0] * x[0] + p.N[1] * x[1] + p.N[2] * x[2] + p.N[3] * x[3];
            visit(p);
        }
    }
}

}  // namespace

void for_each_point(const VolumeMesh& mesh, bool fine, const std::function<void(const Point&)>& visit) {
    tet_points(mesh, fine, visit);
    const auto rule = line_rule(fine);
    for (const Hex& hex : mesh.hexes)
        for (const auto& [r, wr] : rule)
            for (const auto& [s, ws] : rule)
                for (const auto& [t, wt] : rule) hex_point(mesh, hex, Vec3(r, s, t), wr * ws * wt, visit);
}

void for_each_face_point(const VolumeMesh& mesh, const std::function<bool(const Vec3&)>& wanted, const std::function<void(const Point&)>& visit) {
    for_each_face(mesh, [&](std::span<const HalfFace> sides) {
        if (sides.size() != 1) return;
        const Face face = half_face(mesh, sides[0]);
        std::array<Vec3, 4> x;
        for (std::size_t a = 0; a < std::size_t(face.corners); ++a) {
            x[a] = mesh.vertices[std::size_t(face.vertices[a])];
            if (!wanted(x[a])) return;
        }
        Point p;
        p.vertex = std::span(face.vertices.data(), std::size_t(face.corners));
        if (face.corners == 3) triangle_points({x[0], x[1], x[2]}, p, visit);
        else quad_points(x, p, visit);
    });
}

std::vector<Vec3> traction_forces(const VolumeMesh& mesh, const std::function<bool(const Vec3&)>& wanted,
                                  const std::function<Vec3(const Vec3& X, const Vec3& n)>& traction) {
    std::vector<Vec3> forces(mesh.vertices.size(), Vec3::Zero());
    for_each_face_point(mesh, wanted, [&](const Point& p) {
        const Vec3 t = traction(p.X, p.normal);
        for (std::size_t a = 0; a < p.vertex.size(); ++a) forces[std::size_t(p.vertex[a])] += p.weight * p.N[a] * t;
    });
    return forces;
}

std::vector<Vec3> body_forces(const VolumeMesh& mesh, const std::function<Vec3(const Vec3& X)>& force) {
    std::vector<Vec3> forces(mesh.vertices.size(), Vec3::Zero());
    for_each_point(mesh, false, [&](const Point& p) {
        const Vec3 b = force(p.X);
        for (std::size_t a = 0; a < p.vertex.size(); ++a) forces[std::size_t(p.vertex[a])] += p.weight * p.N[a] * b;
    });
    return forces;
}

FieldErrors field_errors(const VolumeMesh& mesh, std::span<const Vec3> positions, const std::function<Vec3(const Vec3&)>& displacement,
                         const std::function<Mat3(const Vec3&)>& gradient) {
    double l2 = 0, l2_size = 0, h1 = 0, h1_size = 0;
    for_each_point(mesh, true, [&](const Point& p) {
        Vec3 u = Vec3::Zero();
        Mat3 g = Mat3::Zero();
        for (std::size_t a = 0; a < p.vertex.size(); ++a) {
            const Vec3 ua = positions[std::size_t(p.vertex[a])] - mesh.vertices[std::size_t(p.vertex[a])];
            u += p.N[a] * ua;
            g += ua * p.gradient[a].transpose();
        }
        const Vec3 exact = displacement(p.X);
        const Mat3 exact_gradient = gradient(p.X);
        l2 += p.weight * (u - exact).squaredNorm();
        l2_size += p.weight * exact.squaredNorm();
        h1 += p.weight * (g - exact_gradient).squaredNorm();
        h1_size += p.weight * exact_gradient.squaredNorm();
    });
    return {std::sqrt(l2 / l2_size), std::sqrt(h1 / h1_size)};
}

double stress_error(const VolumeMesh& mesh, std::span<const Voigt> at_vertices, std::span<const Voigt> at_elements,
                    const std::function<Mat3(const Vec3&)>& exact) {
    double sum = 0, size = 0;
    std::size_t element = 0, points = 0;
    const std::int32_t* last = nullptr;
    for_each_point(mesh, true, [&](const Point& p) {
        if (points++ > 0 && p.vertex.data() != last) ++element;  // the points of an element come one after the other
        last = p.vertex.data();
        Mat3 s = Mat3::Zero();
        if (at_vertices.empty()) s = tensor(at_elements[element]);
        else
            for (std::size_t a = 0; a < p.vertex.size(); ++a) s += p.N[a] * tensor(at_vertices[std::size_t(p.vertex[a])]);
        const Mat3 e = exact(p.X);
        sum += p.weight * (s - e).squaredNorm();
        size += p.weight * e.squaredNorm();
    });
    return std::sqrt(sum / size);
}

Mat3 tensor(const Voigt& s) {
    Mat3 S;
    S << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    return S;
}

}  // namespace supple::verify
