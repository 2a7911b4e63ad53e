// A skin after its mesh was edited: cut (skin_cut.cpp), or healed.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "supple/mesh/skin.h"
#include "supple/mesh/skin_cut.h"
#include "supple/mesh/surface.h"

namespace supple {

struct Skin::Parts {
    mesh::TriangleMesh surface;
    std::vector<std::int32_t> element;  ///< [vertex] it is bound to
    std::vector<TextureCorners> texture;
    std::vector<std::int32_t> opened;
    std::shared_ptr<const Origin> origin;
};

namespace {

constexpr double kHealedArea = 1e-9;  // of the skin's area

/// Axes of what was laid open, the one across it last: a flat cut is mapped onto its plane, anything else from its six sides.
Mat3 axes_of(const mesh::OpenedSurface& opened) {
    Mat3 sum = Mat3::Zero();
    for (std::size_t c = 0; c < opened.faces; ++c) {
        const Triangle& t = opened.surface.triangles[c];
        const auto x = [&](std::size_t k) -> const Vec3& { return opened.surface.vertices[std::size_t(t[k])]; };
        const Vec3 area = (x(1) - x(0)).cross(x(2) - x(0));
        if (area.norm() > 0) sum += area * area.transpose() / area.norm();
    }
    Mat3 axes = Eigen::SelfAdjointEigenSolver<Mat3>(sum).eigenvectors();
    for (Eigen::Index k = 0; k < 3; ++k) {  // always the same way round
        Eigen::Index most = 0;
        axes.col(k).cwiseAbs().maxCoeff(&most);
        if (axes(most, k) < 0) axes.col(k) *= -1;
    }
    return axes;
}

bool merges(const TopologyDelta& delta) {
    for (std::size_t v = 0; v < delta.vertex_parents.size(); ++v)
        if (delta.is_merged(v)) return true;
    return false;
}

}  // namespace

Skin::Skin(Parts parts, const VolumeMesh& mesh)
    : surface_(std::move(parts.surface)), texture_(std::move(parts.texture)), opened_(std::move(parts.opened)), embedding_(Embedding::bound(mesh, surface_.vertices, std::move(parts.element))),
      mesh_vertices_(mesh.vertices.size()), origin_(std::move(parts.origin)) {}

std::shared_ptr<const Skin::Origin> Skin::origin() const { return origin_ ? origin_ : std::make_shared<const Origin>(Origin{surface_, texture_, area_of(surface_)}); }

std::shared_ptr<const Skin> Skin::follow(const VolumeMesh& before, const MeshEdit& edit) const {
    if (merges(edit.delta)) return healed(before, edit);
    Parts out;
    mesh::SkinCut cut = mesh::cut_skin(surface_, embedding_, before, edit);
    out.surface = std::move(cut.surface);
    out.element = std::move(cut.element);
    out.origin = origin();
    const mesh::Hosts hosts(before, edit);
    const Mat3 axes = axes_of(cut.opened);
    for (const mesh::SkinPiece& piece : cut.pieces) {
        const auto x = [&](std::size_t k) -> const Vec3& { return cut.rest[std::size_t(piece.corner[k])]; };
        const Vec3 middle = (x(0) + x(1) + x(2)) / 3;
        TextureCorners uv{};
        if (piece.lip >= 0) {
            Eigen::Index across = 2;
            ((x(1) - x(0)).cross(x(2) - x(0)).transpose() * axes).cwiseAbs().maxCoeff(&across);
            for (std::size_t k = 0; k < 3; ++k) uv[k] = {axes.col((across + 1) % 3).dot(x(k)), axes.col((across + 2) % 3).dot(x(k))};
            out.opened.push_back(piece.element);
        } else {
            const Triangle& t = surface_.triangles[std::size_t(piece.triangle)];
            for (std::size_t k = 0; k < 3 && !texture_.empty(); ++k) {
                const auto w = mesh::barycentric(x(k), surface_.vertices[std::size_t(t[0])], surface_.vertices[std::size_t(t[1])], surface_.vertices[std::size_t(t[2])]);
                for (std::size_t c = 0; c < 2; ++c)
                    for (std::size_t m = 0; m < 3; ++m) uv[k][c] += w[m] * texture_[std::size_t(piece.triangle)][m][c];
            }
            const std::int32_t inner = opened_.empty() ? -1 : opened_[std::size_t(piece.triangle)];
            out.opened.push_back(inner < 0 ? -1 : hosts.host({&inner, 1}, middle));
        }
        out.texture.push_back(uv);
    }
    const bool has_inner = std::any_of(out.opened.begin(), out.opened.end(), [](std::int32_t e) { return e >= 0; });
    if (texture_.empty() && !has_inner) out.texture.clear();
    return std::shared_ptr<const Skin>(new Skin(std::move(out), edit.mesh));
}

std::shared_ptr<const Skin> Skin::healed(const VolumeMesh& before, const MeshEdit& edit) const {
    const mesh::Hosts hosts(before, edit);
    const BoundarySurface boundary = extract_boundary(edit.mesh);
    // An opened face is shut where its element has no boundary there any more.
    const auto is_shut = [&](std::int32_t element, const Vec3& x, double size) {
        const auto first = std::lower_bound(boundary.element.begin(), boundary.element.end(), element);
        for (auto i = first; i != boundary.element.end() && *i == element; ++i) {
            const Triangle& t = boundary.triangles[std::size_t(i - boundary.element.begin())];
            const auto X = [&](std::size_t k) -> const Vec3& { return edit.mesh.vertices[std::size_t(t[k])]; };
            if (nearest_on_triangle(x, X(0), X(1), X(2)).distance < 1e-5 * size) return false;
        }
        return true;
    };
    Parts out;
    out.origin = origin();
    double area = 0;
    bool inner = false;
    std::map<std::int32_t, std::int32_t> number;
    struct Bound {
        Vec3 x;
        std::vector<std::pair<std::int32_t, double>> weights;
        std::int32_t vertex;
    };
    std::map<std::array<double, 3>, std::vector<Bound>> at;  // vertices by place: those of two lips that move alike from now on are one
    const auto vertex = [&](std::int32_t p) {
        const auto [known, is_new] = number.try_emplace(p, -1);
        if (!is_new) return known->second;
        const Vec3& x = surface_.vertices[std::size_t(p)];
        const std::int32_t e = hosts.host({&embedding_.elements()[std::size_t(p)], 1}, x);
        std::array<double, Embedding::kMaxCorners> w{};
        shape_weights(edit.mesh, e, x, w);
        Bound bound{x, {}, std::int32_t(out.surface.vertices.size())};
        const auto ids = element_vertices(edit.mesh, std::size_t(e));
        for (std::size_t k = 0; k < ids.size(); ++k)
            if (std::abs(w[k]) > 1e-6) bound.weights.emplace_back(ids[k], w[k]);
        std::sort(bound.weights.begin(), bound.weights.end());
        std::vector<Bound>& here = at[{x[0], x[1], x[2]}];
        for (const Bound& other : here) {
            bool same = other.weights.size() == bound.weights.size();
            for (std::size_t k = 0; same && k < bound.weights.size(); ++k)
                same = other.weights[k].first == bound.weights[k].first && std::abs(other.weights[k].second - bound.weights[k].second) < 1e-5;
            if (same) return known->second = other.vertex;
        }
        out.surface.vertices.push_back(x);
        out.element.push_back(e);
        here.push_back(bound);
        return known->second = bound.vertex;
    };
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
        const Triangle& old = surface_.triangles[t];
        const auto x = [&](std::size_t k) -> const Vec3& { return surface_.vertices[std::size_t(old[k])]; };
        const Vec3 normal = (x(1) - x(0)).cross(x(2) - x(0));
        std::int32_t opened = -1;
        if (is_inner(t)) {
            const Vec3 middle = (x(0) + x(1) + x(2)) / 3;
            opened = hosts.host({&opened_[t], 1}, middle);
            const auto ids = element_vertices(edit.mesh, std::size_t(opened));
            if (is_shut(opened, middle, (edit.mesh.vertices[std::size_t(ids[0])] - edit.mesh.vertices[std::size_t(ids[1])]).norm())) continue;
            inner = true;
        } else {
            area += 0.5 * normal.norm();
        }
        const Triangle now{vertex(old[0]), vertex(old[1]), vertex(old[2])};
        if (now[0] == now[1] || now[1] == now[2] || now[2] == now[0]) continue;
        out.surface.triangles.push_back(now);
        out.opened.push_back(opened);
        if (!texture_.empty()) out.texture.push_back(texture_[t]);
    }
    if (!inner && std::abs(area - out.origin->area) <= kHealedArea * out.origin->area)
        return std::shared_ptr<const Skin>(new Skin(out.origin->surface, out.origin->texture, edit.mesh));
    return std::shared_ptr<const Skin>(new Skin(std::move(out), edit.mesh));
}

}  // namespace supple
