// Dihedral angle along the edge e from p to q, between its faces through r and s. Their normals m = e x (r-p), n = e x (s-p)
// enclose it: cos ~ m.n, sin ~ |m x n|; atan2 keeps both ends accurate.
//
// Inscribed radius  r = 3V / (sum of face areas).  Circumscribed radius, with u v w the edges from a (x the centre from a: 2 u.x = |u|^2,
// likewise v, w):
//     R = | |u|^2 (v x w) + |v|^2 (w x u) + |w|^2 (u x v) | / (12 V).
#include "supple/mesh/quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {
namespace {

double dihedral_deg(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    const Vec3 e = q - p, m = e.cross(r - p), n = e.cross(s - p);
    return std::atan2(m.cross(n).norm(), m.dot(n)) * 180 / std::numbers::pi;
}

}  // namespace

TetQuality tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const std::array<Vec3, 4> x{a, b, c, d};
    constexpr std::array<std::array<int, 4>, 6> edges{{{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};
    TetQuality quality{180, 0, 0};
    for (const auto& e : edges) {
        const double angle = dihedral_deg(x[e[0]], x[e[1]], x[e[2]], x[e[3]]);
        quality.min_dihedral_deg = std::min(quality.min_dihedral_deg, angle);
        quality.max_dihedral_deg = std::max(quality.max_dihedral_deg, angle);
    }
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double six_v = std::abs(u.dot(v.cross(w)));
    const double twice_area = u.cross(v).norm() + v.cross(w).norm() + w.cross(u).norm() + (v - u).cross(w - u).norm();
    const double circum = (u.squaredNorm() * v.cross(w) + v.squaredNorm() * w.cross(u) + w.squaredNorm() * u.cross(v)).norm();
    // r = six_v / twice_area, R = circum / (2 six_v)
    if (six_v > 0) quality.radius_ratio = std::min(1.0, 6 * six_v / twice_area * six_v / circum);
    return quality;
}

double hex_scaled_jacobian(const std::array<Vec3, 8>& x) {
    // The neighbours of each corner, right-handed.
    constexpr int next[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};
    double least = 1;
    for (int c = 0; c < 8; ++c) {
        const Vec3 u = x[next[c][0]] - x[c], v = x[next[c][1]] - x[c], w = x[next[c][2]] - x[c];
        const double lengths = u.norm() * v.norm() * w.norm();
        least = std::min(least, lengths > 0 ? u.dot(v.cross(w)) / lengths : 0.0);
    }
    return least;
}

MeshQuality tet_mesh_quality(const VolumeMesh& mesh) {
    MeshQuality out;
    if (mesh.tets.empty()) return out;
    out.min_dihedral_deg = 180;
    out.min_radius_ratio = 1;
    for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
        const Tet& t = mesh.tets[i];
        const TetQuality q = tet_quality(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], mesh.vertices[t[3]]);
        out.min_dihedral_deg = std::min(out.min_dihedral_deg, q.min_dihedral_deg);
        out.max_dihedral_deg = std::max(out.max_dihedral_deg, q.max_dihedral_deg);
        out.mean_radius_ratio += q.radius_ratio;
        if (out.worst_tet < 0 || q.radius_ratio < out.min_radius_ratio) {
            out.min_radius_ratio = q.radius_ratio;
            out.worst_tet = static_cast<std::int32_t>(i);
        }
    }
    out.mean_radius_ratio /= static_cast<double>(mesh.tets.size());
    return out;
}

}  // namespace supple
