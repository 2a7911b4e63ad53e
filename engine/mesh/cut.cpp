// Cutting with a blade, in five steps.
//
// 1. Crossings. An edge a b meets a triangle p q r where a and b lie on different sides of its plane and the line a b passes all three of its edges on the same side:
//    det(p - a, q - a, b - a) and so on, evaluated with the triangle's edge in a fixed direction, so that two triangles at an edge give numbers that are exactly opposite:
//    nothing slips between them. An odd number of crossings counts as its middle one, an even number as none.
// 2. Snapping. A vertex near to a crossing is put on the cut: none of its edges is split then.
// 3. Splitting. Edges are split one after the other, each in all tets around it, in an order that all tets know; a tet with an edge a b becomes two, with m for a and m for b. So
//    neighbours fit whatever the pattern of crossed edges. Once every edge that joins the two sides is split, no part has corners on both sides, and the parts of the two
//    sides meet in faces whose corners all lie on the cut. (One corner: 4 parts, 3 of them a prism; two and two: 6 parts, two prisms.)
// 4. Bounds. A part below a bound snaps the crossing at its corners that is nearest to a vertex, and 3 begins again. Every round snaps one more, so this ends.
// 5. Opening. Torn are the faces whose corners all lie on the cut and whose two parts lie on different sides of the blade.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "supple/base/error.h"
#include "supple/mesh/box_tree.h"
#include "supple/mesh/edit_draft.h"
#include "supple/mesh/quality.h"
#include "supple/mesh/topology.h"
#include "supple/mesh/triangle_tree.h"

namespace supple {

namespace {

[[noreturn]] void refuse(const std::string& where, const std::string& message) { throw Error(ErrorCode::invalid_argument, where, message); }

constexpr std::array<std::array<std::size_t, 2>, 6> kTetEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

using Edge = std::array<std::int32_t, 2>;

Edge edge_of(std::int32_t a, std::int32_t b) { return a < b ? Edge{a, b} : Edge{b, a}; }

/// Side of the line a b on which the edge p q passes, with the same bits but for the sign in both directions.
double passes(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q, bool turned) {
    const Vec3 u = (turned ? q : p) - a, w = (turned ? p : q) - a;
    const double d = (b - a).dot(u.cross(w));
    return turned ? -d : d;
}

class Blade {
public:
    explicit Blade(const mesh::TriangleMesh& surface) : surface_(surface) {
        if (surface.triangles.empty()) refuse("cut", "the blade has no triangle");
        for (const Triangle& t : surface.triangles) {
            Box box;
            for (const std::int32_t v : t) {
                if (v < 0 || std::size_t(v) >= surface.vertices.size())
                    refuse("cut", "a triangle of the blade uses vertex " + std::to_string(v) + "; it has " + std::to_string(surface.vertices.size()));
                if (!surface.vertices[std::size_t(v)].allFinite()) refuse("cut", "vertex " + std::to_string(v) + " of the blade is not finite");
                box.include(surface.vertices[std::size_t(v)]);
                all_.include(surface.vertices[std::size_t(v)]);
            }
            boxes_.push_back(box);
        }
    }

    bool meets(const Box& box) const {
        return box.overlaps(all_) && std::any_of(boxes_.begin(), boxes_.end(), [&](const Box& b) { return b.overlaps(box); });
    }

    struct Hit {
        double t;  ///< from a
        int side;  ///< of a
    };
    std::optional<Hit> crossing(const Vec3& a, const Vec3& b) const {
        std::vector<Hit> hits;
        Box box;
        box.include(a);
        box.include(b);
        for (std::size_t i = 0; i < boxes_.size(); ++i) {
            if (!boxes_[i].overlaps(box)) continue;
            const Triangle& tri = surface_.triangles[i];
            const auto P = [&](std::size_t k) -> const Vec3& { return surface_.vertices[std::size_t(tri[k % 3])]; };
            const Vec3 n = (P(1) - P(0)).cross(P(2) - P(0));
            const double da = n.dot(a - P(0)), db = n.dot(b - P(0));
            if ((da >= 0) == (db >= 0)) continue;
            bool left = true, right = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const double s = passes(a, b, P(k), P(k + 1), tri[k % 3] > tri[(k + 1) % 3]);
                left = left && s >= 0;
                right = right && s <= 0;
            }
            if (left || right) hits.push_back({da / (da - db), da >= 0 ? 1 : -1});
        }
        std::sort(hits.begin(), hits.end(), [](const Hit& x, const Hit& y) { return x.t < y.t; });
        // Through an edge of the blade: two triangles, one crossing.
        hits.erase(std::unique(hits.begin(), hits.end(), [](const Hit& x, const Hit& y) { return x.side == y.side && y.t - x.t < 1e-9; }), hits.end());
        if (hits.size() % 2 == 0) return std::nullopt;
        return hits[hits.size() / 2];
    }

    /// Signed distance from the plane of the nearest triangle; of equally near ones the one that sees x most from the front or back.
    double side(const Vec3& x) const {
        double nearest = std::numeric_limits<double>::infinity(), best = 0;
        for (const Triangle& tri : surface_.triangles) {
            const auto P = [&](std::size_t k) -> const Vec3& { return surface_.vertices[std::size_t(tri[k])]; };
            const NearestPoint p = nearest_on_triangle(x, P(0), P(1), P(2));
            if (p.distance > nearest * (1 + 1e-9)) continue;
            const Vec3 n = (P(1) - P(0)).cross(P(2) - P(0));
            const double length = n.norm();
            const double d = length > 0 ? n.dot(x - p.point) / length : 0;
            if (p.distance < nearest * (1 - 1e-9) || std::abs(d) > std::abs(best)) best = d;
            nearest = std::min(nearest, p.distance);
        }
        return best;
    }

private:
    const mesh::TriangleMesh& surface_;
    Box all_;
    std::vector<Box> boxes_;
};

struct Crossing {
    Edge edge;
    double t;        ///< from edge[0]
    int side;        ///< of edge[0]
    double length;   ///< of the edge at rest
    bool active = true;
};

struct Part {
    std::array<std::int32_t, 4> vertex;  ///< numbers beyond the mesh's: crossings
    std::int32_t parent;
};

class Cutter {
public:
    Cutter(const VolumeMesh& mesh, std::span<const Vec3> x, const Blade& blade, const CutDef& def, CutReport& report)
        : mesh_(mesh), x_(x), blade_(blade), def_(def), report_(report), on_cut_(mesh.vertices.size(), 0), met_(mesh.vertices.size(), 0), vote_(mesh.vertices.size(), 0) {
        double volume = 0;
        for (const Tet& t : mesh.tets) volume += tet_volume(X(t[0]), X(t[1]), X(t[2]), X(t[3]));
        least_volume_ = mesh.tets.empty() ? 0 : def.min_volume_share * volume / double(mesh.tets.size());
    }

    MeshEdit run() {
        find_crossings();
        for (int round = 0;; ++round) {
            split_within_bounds();
            find_faces();
            if (round == 3 || !drop_useless()) break;
        }
        return open();
    }

private:
    const Vec3& X(std::int32_t v) const { return mesh_.vertices[std::size_t(v)]; }
    std::int32_t first_point() const { return std::int32_t(mesh_.vertices.size()); }
    const Crossing& at(std::int32_t point) const { return crossings_[std::size_t(point - first_point())]; }

    template <class Points>
    Vec3 place(const Points& p, std::int32_t v) const {
        if (v < first_point()) return p[std::size_t(v)];
        const Crossing& c = at(v);
        return (1 - c.t) * p[std::size_t(c.edge[0])] + c.t * p[std::size_t(c.edge[1])];
    }

    void find_crossings() {
        std::vector<Edge> edges;
        for (std::size_t e = 0; e < mesh_.tets.size(); ++e) {
            Box box;
            for (const std::int32_t v : mesh_.tets[e]) box.include(x_[std::size_t(v)]);
            if (!blade_.meets(box)) continue;
            for (const auto& k : kTetEdges) edges.push_back(edge_of(mesh_.tets[e][k[0]], mesh_.tets[e][k[1]]));
        }
        std::vector<Edge> of_hexes;
        if (!edges.empty())
            for (const Hex& h : mesh_.hexes)
                for (std::size_t a = 0; a < 8; ++a)  // diagonals, too: a face may be shared with two tets
                    for (std::size_t b = a + 1; b < 8; ++b) of_hexes.push_back(edge_of(h[a], h[b]));
        for (auto* list : {&edges, &of_hexes}) {
            std::sort(list->begin(), list->end());
            list->erase(std::unique(list->begin(), list->end()), list->end());
        }
        for (const Edge& e : edges) {
            const auto hit = blade_.crossing(x_[std::size_t(e[0])], x_[std::size_t(e[1])]);
            if (!hit) continue;
            Crossing c{e, hit->t, hit->side, (X(e[1]) - X(e[0])).norm()};
            vote_[std::size_t(e[0])] += c.side;
            vote_[std::size_t(e[1])] -= c.side;
            met_[std::size_t(e[0])] = met_[std::size_t(e[1])] = 1;
            crossings_.push_back(c);
            const bool rigid = std::binary_search(of_hexes.begin(), of_hexes.end(), e);
            if (rigid || std::min(c.t, 1 - c.t) < def_.snap) snap(c);
        }
        // A snapped vertex puts faces on the cut that the blade passes by: all tets at an end of a crossed edge are looked at.
        near_.clear();
        for (std::size_t e = 0; e < mesh_.tets.size() && !crossings_.empty(); ++e)
            if (std::any_of(mesh_.tets[e].begin(), mesh_.tets[e].end(), [&](std::int32_t v) { return met_[std::size_t(v)] != 0; })) near_.push_back(std::int32_t(e));
        // Longest first; where two are equally long, by number.
        std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) { return a.length != b.length ? a.length > b.length : a.edge < b.edge; });
        report_.crossings = crossings_.size();
        for (std::size_t i = 0; i < crossings_.size(); ++i) point_of_[crossings_[i].edge] = first_point() + std::int32_t(i);
    }

    void snap(const Crossing& c) { on_cut_[std::size_t(c.t <= 0.5 ? c.edge[0] : c.edge[1])] = 1; }

    bool is_split(const Crossing& c) const { return c.active && !on_cut_[std::size_t(c.edge[0])] && !on_cut_[std::size_t(c.edge[1])]; }
    bool is_zero(std::int32_t v) const { return v >= first_point() || on_cut_[std::size_t(v)] != 0; }

    void split(std::int32_t tet) {
        std::vector<std::int32_t> points;
        for (const auto& k : kTetEdges) {
            const auto found = point_of_.find(edge_of(mesh_.tets[std::size_t(tet)][k[0]], mesh_.tets[std::size_t(tet)][k[1]]));
            if (found != point_of_.end() && is_split(at(found->second))) points.push_back(found->second);
        }
        std::sort(points.begin(), points.end());
        std::vector<std::array<std::int32_t, 4>> pieces{mesh_.tets[std::size_t(tet)]};
        for (const std::int32_t p : points) {
            const Edge e = at(p).edge;
            const std::size_t n = pieces.size();
            for (std::size_t i = 0; i < n; ++i) {
                const auto a = std::find(pieces[i].begin(), pieces[i].end(), e[0]) - pieces[i].begin();
                const auto b = std::find(pieces[i].begin(), pieces[i].end(), e[1]) - pieces[i].begin();
                if (a == 4 || b == 4) continue;
                auto other = pieces[i];
                pieces[i][std::size_t(a)] = p;
                other[std::size_t(b)] = p;
                pieces.push_back(other);
            }
        }
        for (const auto& piece : pieces) parts_.push_back({piece, tet});
    }

    TetQuality quality(const std::array<std::int32_t, 4>& v) const {
        return tet_quality(place(mesh_.vertices, v[0]), place(mesh_.vertices, v[1]), place(mesh_.vertices, v[2]), place(mesh_.vertices, v[3]));
    }

    void split_within_bounds() {
        std::map<std::int32_t, double> bound;
        for (bool again = true; again;) {
            again = false;
            parts_.clear();
            for (const std::int32_t t : near_) split(t);
            for (std::size_t i = 0; i < parts_.size(); ++i) {
                const auto& v = parts_[i].vertex;
                std::int32_t worst = -1;
                for (const std::int32_t p : v)
                    if (p >= first_point() && is_split(at(p)) && (worst < 0 || std::min(at(p).t, 1 - at(p).t) < std::min(at(worst).t, 1 - at(worst).t))) worst = p;
                if (worst < 0) continue;
                const auto [known, is_new] = bound.try_emplace(parts_[i].parent, 0.0);
                if (is_new) known->second = std::min(def_.min_radius_ratio, quality(mesh_.tets[std::size_t(parts_[i].parent)]).radius_ratio);
                const double volume = tet_volume(place(mesh_.vertices, v[0]), place(mesh_.vertices, v[1]), place(mesh_.vertices, v[2]), place(mesh_.vertices, v[3]));
                if (volume >= least_volume_ && volume > 0 && quality(v).radius_ratio >= known->second) continue;
                snap(at(worst));
                again = true;
            }
        }
    }

    /// +1 or -1; of a part with no corner off the cut, +1.
    int side_of(const Part& part) const {
        double farthest = 0;
        for (const std::int32_t v : part.vertex) {
            if (is_zero(v)) continue;
            if (vote_[std::size_t(v)] != 0) return vote_[std::size_t(v)] > 0 ? 1 : -1;
            const double d = blade_.side(x_[std::size_t(v)]);
            if (std::abs(d) > std::abs(farthest)) farthest = d;
        }
        return farthest < 0 ? -1 : 1;
    }

    void find_faces() {
        std::map<mesh::FaceKey, std::vector<std::int32_t>> sides;
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            for (const auto& f : kTetFaces) {
                mesh::FaceKey key{-1, -1, -1, -1};
                for (std::size_t k = 0; k < 3; ++k) key[k] = parts_[i].vertex[std::size_t(f[k])];
                if (!is_zero(key[0]) || !is_zero(key[1]) || !is_zero(key[2])) continue;
                sides[mesh::ascending(key, 3)].push_back(std::int32_t(i));
            }
        }
        torn_.clear();
        for (const auto& [key, at_face] : sides)
            if (at_face.size() == 2 && side_of(parts_[std::size_t(at_face[0])]) != side_of(parts_[std::size_t(at_face[1])])) torn_.insert(key);
    }

    /// Edges that were split for nothing: their points are on no torn face.
    bool drop_useless() {
        std::set<std::int32_t> used;
        for (const mesh::FaceKey& key : torn_) used.insert(key.begin(), key.end());
        bool any = false;
        for (std::size_t i = 0; i < crossings_.size(); ++i) {
            if (!is_split(crossings_[i]) || used.contains(first_point() + std::int32_t(i))) continue;
            crossings_[i].active = false;
            any = true;
        }
        return any;
    }

    /// Faces between hexes whose centres lie on both sides.
    void tear_hexes(const mesh::Draft& draft, std::set<mesh::FaceKey>& torn) const {
        std::map<mesh::FaceKey, std::int32_t> first;
        const auto centre = [&](std::size_t h) {
            Vec3 c = Vec3::Zero();
            for (const std::int32_t v : mesh_.hexes[h]) c += x_[std::size_t(v)] / 8;
            return c;
        };
        std::vector<Vec3> centres;
        for (std::size_t h = 0; h < mesh_.hexes.size(); ++h) centres.push_back(centre(h));
        for (std::size_t h = 0; h < mesh_.hexes.size(); ++h) {
            for (int f = 0; f < 6; ++f) {
                const mesh::FaceKey key = draft.face(std::int32_t(mesh_.tets.size() + h), f);
                const auto [other, is_new] = first.emplace(key, std::int32_t(h));
                if (is_new) continue;
                if (blade_.crossing(centres[std::size_t(other->second)], centres[h])) torn.insert(key);
            }
        }
    }

    MeshEdit open() {
        mesh::Draft draft(mesh_);
        std::map<std::int32_t, std::int32_t> number;  // of the points that are used
        const auto numbered = [&](std::int32_t v) {
            if (v < first_point()) return v;
            const auto [found, is_new] = number.emplace(v, -1);
            if (is_new) found->second = draft.add_point(at(v).edge[0], at(v).edge[1], at(v).t);
            return found->second;
        };
        if (!torn_.empty()) {
            for (std::size_t i = 0; i < parts_.size(); ++i) {
                const std::int32_t parent = parts_[i].parent;
                const bool whole = parts_[i].vertex == mesh_.tets[std::size_t(parent)];
                if (whole) continue;
                mesh::DraftElement part;
                for (std::size_t a = 0; a < 4; ++a) part.vertex[a] = numbered(parts_[i].vertex[a]);
                part.parent = parent;
                draft.elements[std::size_t(parent)].alive = false;
                draft.elements.push_back(part);
                draft.elements.back().share = draft.volume(std::int32_t(draft.elements.size() - 1)) / draft.volume(parent);
            }
        }
        std::set<mesh::FaceKey> torn;
        for (mesh::FaceKey key : torn_) {
            for (std::size_t k = 0; k < 3; ++k) key[k] = numbered(key[k]);
            torn.insert(mesh::ascending(key, 3));
        }
        tear_hexes(draft, torn);
        std::set<std::int32_t> affected;
        for (const mesh::FaceKey& key : torn)
            for (const std::int32_t v : key)
                if (v >= 0) affected.insert(v);
        if (torn.empty()) return {mesh_, identity_delta(mesh_)};
        draft.separate(torn, affected, false);
        report_.opened_faces = draft.open_faces();
        if (report_.opened_faces == 0) return {mesh_, identity_delta(mesh_)};
        report_.split_edges = number.size();
        report_.snapped = std::size_t(std::count_if(crossings_.begin(), crossings_.end(), [&](const Crossing& c) { return c.active && !is_split(c); }));
        return draft.finish();
    }

    const VolumeMesh& mesh_;
    std::span<const Vec3> x_;
    const Blade& blade_;
    const CutDef& def_;
    CutReport& report_;
    std::vector<char> on_cut_, met_;
    std::vector<int> vote_;  ///< sides of the blade on which crossed edges see a vertex
    double least_volume_ = 0;
    std::vector<std::int32_t> near_;
    std::vector<Crossing> crossings_;
    std::map<Edge, std::int32_t> point_of_;
    std::vector<Part> parts_;
    std::set<mesh::FaceKey> torn_;
};

}  // namespace

MeshEdit cut(const VolumeMesh& mesh, std::span<const Vec3> positions, const mesh::TriangleMesh& surface, const CutDef& def, CutReport* report) {
    if (positions.size() != mesh.vertices.size())
        refuse("cut", std::to_string(positions.size()) + " positions for a mesh of " + std::to_string(mesh.vertices.size()) + " vertices");
    require_in_range(def.snap, 0, 0.5, "CutDef.snap", "0.1 is usual");
    require_in_range(def.min_radius_ratio, 0, 1, "CutDef.min_radius_ratio", "0.05 is usual");
    require_in_range(def.min_volume_share, 0, 1, "CutDef.min_volume_share", "0.001 is usual");
    for (const Vec3& x : positions)
        if (!x.allFinite()) refuse("cut", "a position is not finite");
    CutReport unread;
    if (report == nullptr) report = &unread;
    *report = {};
    const Blade blade(surface);
    return Cutter(mesh, positions, blade, def, *report).run();
}

mesh::TriangleMesh swept_blade(std::span<const Vec3> from, std::span<const Vec3> to) {
    if (from.size() != to.size()) refuse("swept_blade", "the poses have " + std::to_string(from.size()) + " and " + std::to_string(to.size()) + " points");
    if (from.size() < 2) refuse("swept_blade", "a blade needs two points or more");
    mesh::TriangleMesh out;
    out.vertices.assign(from.begin(), from.end());
    out.vertices.insert(out.vertices.end(), to.begin(), to.end());
    const auto n = std::int32_t(from.size());
    for (std::int32_t i = 0; i + 1 < n; ++i)
        for (const Triangle& t : {Triangle{i, i + 1, n + i + 1}, Triangle{i, n + i + 1, n + i}}) {
            const auto P = [&](std::size_t k) -> const Vec3& { return out.vertices[std::size_t(t[k])]; };
            if ((P(1) - P(0)).cross(P(2) - P(0)).squaredNorm() > 0) out.triangles.push_back(t);
        }
    return out;
}

}  // namespace supple
