// A skin after its mesh was edited. What the edit laid open is a surface of faces (mesh/opened_surface), which goes on in walls where it reaches the boundary, for skins a little
// outside of it. Skin and opened surface cut one another (mesh/surface_crossing). A part of the skin at their common line belongs to the element behind the opened face on its side; parts
// of the opened surface within the skin are drawn twice, a lip for each side. Which corners at a point are one vertex is what hangs together around it: across edges that are on
// no line, along a lip from face to face, and across the line from a lip to the skin of its side. So the lips end where they should, and a closed skin stays closed.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "supple/base/disjoint_sets.h"
#include "supple/mesh/opened_surface.h"
#include "supple/mesh/skin.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/surface_crossing.h"

namespace supple {

struct Skin::Parts {
    mesh::TriangleMesh surface;
    std::vector<std::int32_t> element;  ///< [vertex] it is bound to
    std::vector<TextureCorners> texture;
    std::vector<std::int32_t> opened;
    std::shared_ptr<const Origin> origin;
};

namespace {

constexpr double kTolerance = 1e-7;   // of the mean edge of the opened faces: nearer points are one
constexpr double kWallHeight = 2;     // in those edges: skins are cut that lie so far outside
constexpr double kHealedArea = 1e-9;  // of the skin's area

using Edge = std::pair<std::int32_t, std::int32_t>;

/// How far an element's shape functions reach to a point: the least weight, positive inside.
double least_weight(const VolumeMesh& mesh, std::int32_t element, const Vec3& x) {
    std::array<double, Embedding::kMaxCorners> w{};
    shape_weights(mesh, element, x, w);
    return *std::min_element(w.begin(), w.begin() + std::ptrdiff_t(element_vertices(mesh, std::size_t(element)).size()));
}

/// What became of the elements of the mesh before.
class Hosts {
public:
    explicit Hosts(const VolumeMesh& before, const MeshEdit& edit) : mesh_(edit.mesh), first_(before.element_count() + 1, 0), parts_(edit.delta.element_parent.size()) {
        for (const std::int32_t old : edit.delta.element_parent) ++first_[std::size_t(old) + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
        for (std::size_t e = 0; e < parts_.size(); ++e) parts_[std::size_t(next[std::size_t(edit.delta.element_parent[e])]++)] = std::int32_t(e);
    }
    bool lives(std::int32_t old) const { return first_[std::size_t(old)] < first_[std::size_t(old) + 1]; }
    /// The part of one of some old elements that a rest point lies in, or is least outside of; -1 where none lives.
    std::int32_t host(std::span<const std::int32_t> old, const Vec3& x) const {
        std::int32_t best = -1;
        double best_weight = 0;
        for (const std::int32_t o : old) {
            const std::int32_t begin = first_[std::size_t(o)], end = first_[std::size_t(o) + 1];
            if (best < 0 && old.size() == 1 && end == begin + 1) return parts_[std::size_t(begin)];
            for (std::int32_t k = begin; k < end; ++k) {
                const double least = least_weight(mesh_, parts_[std::size_t(k)], x);
                if (best >= 0 && least <= best_weight) continue;
                best = parts_[std::size_t(k)];
                best_weight = least;
            }
        }
        return best;
    }

private:
    const VolumeMesh& mesh_;
    std::vector<std::int32_t> first_, parts_;
};

/// Whether elements of a mesh hang together across few vertices: on one side of a cut, or around its end.
class Neighbours {
public:
    explicit Neighbours(const VolumeMesh& mesh) : mesh_(mesh) {}

    bool joined(std::int32_t a, std::int32_t b) {
        constexpr int kHops = 3;
        if (around_.empty()) {
            around_.resize(mesh_.vertices.size());
            for (std::size_t e = 0; e < mesh_.element_count(); ++e)
                for (const std::int32_t v : element_vertices(mesh_, e)) around_[std::size_t(v)].push_back(std::int32_t(e));
        }
        std::set<std::int32_t> seen{a};
        std::vector<std::int32_t> front{a};
        for (int hop = 0; hop < kHops && !seen.contains(b); ++hop) {
            std::vector<std::int32_t> next;
            for (const std::int32_t e : front)
                for (const std::int32_t v : element_vertices(mesh_, std::size_t(e)))
                    for (const std::int32_t n : around_[std::size_t(v)])
                        if (seen.insert(n).second) next.push_back(n);
            front = std::move(next);
        }
        return seen.contains(b);
    }

private:
    const VolumeMesh& mesh_;
    std::vector<std::vector<std::int32_t>> around_;
};

/// A triangle of the skin to come.
struct Piece {
    Triangle corner;                ///< points
    std::int32_t triangle = -1;     ///< of the skin before, or of the opened surface
    int lip = -1;                   ///< of the opened surface: which of the two; -1: of the skin
    bool gone = false;
    std::int32_t element = -1;      ///< behind it, where the cut says so: of a lip, and of skin at a line
};

/// The skin's triangles that an opened surface may meet: those of elements that the edit changed, or that have a vertex of such.
std::vector<std::int32_t> triangles_near(const mesh::TriangleMesh& skin, std::span<const std::int32_t> element, const VolumeMesh& before, const TopologyDelta& delta) {
    std::vector<char> changed(before.vertices.size(), 0), near(before.element_count(), 0);
    for (std::size_t v = 0; v < changed.size(); ++v) changed[v] = char(delta.vertex_to_new[v] < 0);
    for (const std::int32_t v : delta.added_vertices())
        for (const std::int32_t p : delta.vertex_parents[std::size_t(v)].vertex)
            if (p >= 0) changed[std::size_t(p)] = 1;
    for (std::size_t e = 0; e < near.size(); ++e)
        if (delta.element_to_new[e] < 0)
            for (const std::int32_t v : element_vertices(before, e)) changed[std::size_t(v)] = 1;
    for (int ring = 0; ring < 3; ++ring) {  // a triangle may reach across from elements that the edit did not touch
        for (std::size_t e = 0; e < near.size(); ++e)
            for (const std::int32_t v : element_vertices(before, e)) near[e] = char(near[e] | changed[std::size_t(v)]);
        for (std::size_t e = 0; e < near.size() && ring < 2; ++e)
            if (near[e])
                for (const std::int32_t v : element_vertices(before, e)) changed[std::size_t(v)] = 1;
    }
    std::vector<std::int32_t> out;
    for (std::size_t t = 0; t < skin.triangles.size(); ++t)
        if (std::any_of(skin.triangles[t].begin(), skin.triangles[t].end(), [&](std::int32_t p) { return near[std::size_t(element[std::size_t(p)])] != 0; })) out.push_back(std::int32_t(t));
    return out;
}

class SkinCut {
public:
    SkinCut(const mesh::TriangleMesh& skin, std::span<const std::int32_t> was, const VolumeMesh& before, const MeshEdit& edit)
        : skin_(skin), was_(was), edit_(edit), hosts_(before, edit) {
        const BoundarySurface boundary = extract_boundary(edit.mesh);
        opened_ = mesh::opened_surface(edit, boundary, boundary_parents(before, edit), kWallHeight);
        std::vector<std::int32_t> chosen;
        if (opened_.faces > 0) chosen = triangles_near(skin, was, before, edit.delta);
        crossed_ = mesh::cross_surfaces(skin, chosen, opened_.surface, kTolerance * std::max(opened_.size, 1e-300));
        std::vector<char> is_chosen(skin.triangles.size(), 0);
        for (const std::int32_t t : chosen) is_chosen[std::size_t(t)] = 1;
        for (const auto& part : crossed_.first) pieces_.push_back({part.corner, part.triangle});
        for (std::size_t t = 0; t < is_chosen.size(); ++t)
            if (!is_chosen[t]) pieces_.push_back({skin.triangles[t], std::int32_t(t)});
        std::stable_sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) { return a.triangle < b.triangle; });
        skin_pieces_ = pieces_.size();
    }

    const std::vector<Piece>& pieces() const { return pieces_; }
    const mesh::OpenedSurface& opened() const { return opened_; }
    const Vec3& point(std::int32_t p) const { return crossed_.point[std::size_t(p)]; }

    /// Pieces that stay, and a vertex for each of their corners.
    void run(mesh::TriangleMesh& surface, std::vector<std::int32_t>& element) {
        take_sides();
        add_lips();
        join();
        take_over();
        name(surface, element);
    }

private:
    const Vec3& X(const Piece& piece, std::size_t k) const { return point(piece.corner[k % 3]); }
    Vec3 normal(std::int32_t opened) const {
        const Triangle& t = opened_.surface.triangles[std::size_t(opened)];
        const auto x = [&](std::size_t k) -> const Vec3& { return opened_.surface.vertices[std::size_t(t[k])]; };
        return (x(1) - x(0)).cross(x(2) - x(0)).normalized();
    }
    Vec3 skin_normal(std::int32_t triangle) const {
        const Triangle& t = skin_.triangles[std::size_t(triangle)];
        const auto x = [&](std::size_t k) -> const Vec3& { return skin_.vertices[std::size_t(t[k])]; };
        return (x(1) - x(0)).cross(x(2) - x(0)).normalized();
    }
    /// The pairs of triangles that cross along edge k of a piece; null if none do.
    const std::vector<std::array<std::int32_t, 2>>* line(const Triangle& corner, std::size_t k) const {
        const auto found = crossed_.lines.find(Edge(std::minmax(corner[k], corner[(k + 1) % 3])));
        return found == crossed_.lines.end() ? nullptr : &found->second;
    }
    /// Which lip of an opened triangle a piece of the skin at edge k is on.
    int side_of(const Piece& piece, std::size_t k, std::int32_t opened) const { return normal(opened).dot(X(piece, k + 2) - X(piece, k)) > 0 ? 1 : 0; }

    /// Pieces of the skin at a line: the element behind them. Those at a lip that is gone go with it, and the rest of their triangle as far as no line parts it.
    void take_sides() {
        for (std::size_t i = 0; i < skin_pieces_;) {
            std::size_t end = i;
            while (end < skin_pieces_ && pieces_[end].triangle == pieces_[i].triangle) ++end;
            const Triangle& t = skin_.triangles[std::size_t(pieces_[i].triangle)];
            const auto alive = std::count_if(t.begin(), t.end(), [&](std::int32_t p) { return hosts_.lives(was_[std::size_t(p)]); });
            if (end == i + 1 && !line(pieces_[i].corner, 0) && !line(pieces_[i].corner, 1) && !line(pieces_[i].corner, 2)) {
                pieces_[i++].gone = alive < 2;
                continue;
            }
            std::vector<double> stays(end - i, 0);  // by the lengths of the lines beside it
            DisjointSets together(end - i);
            std::map<Edge, std::size_t> at;
            for (std::size_t j = i; j < end; ++j)
                for (std::size_t k = 0; k < 3; ++k) {
                    Piece& piece = pieces_[j];
                    if (const auto* crossings = line(piece.corner, k)) {
                        for (const auto& [skin, opened] : *crossings) {
                            const std::int32_t e = opened_.lips[std::size_t(opened)][std::size_t(side_of(piece, k, opened))].element;
                            stays[j - i] += (e >= 0 ? 1 : -1) * (X(piece, k + 1) - X(piece, k)).norm();
                            if (piece.element < 0) piece.element = e;
                        }
                        continue;
                    }
                    const auto [known, is_new] = at.try_emplace(Edge(std::minmax(piece.corner[k], piece.corner[(k + 1) % 3])), j);
                    if (!is_new) together.join(known->second - i, j - i);
                }
            std::vector<double> sum(end - i, 0);
            for (std::size_t j = i; j < end; ++j) sum[together.root(j - i)] += stays[j - i];
            for (std::size_t j = i; j < end; ++j) {
                const double vote = sum[together.root(j - i)];
                pieces_[j].gone = vote != 0 ? vote < 0 : alive < 2;
            }
            i = end;
        }
    }

    /// The opened faces within the skin, a piece for each lip: what lies behind the skin's triangles at the lines, and all that hangs together with it.
    void add_lips() {
        DisjointSets together(crossed_.second.size());
        std::vector<double> inside(crossed_.second.size(), 0);
        std::map<Edge, std::size_t> at;
        for (std::size_t i = 0; i < crossed_.second.size(); ++i) {
            const Piece piece{crossed_.second[i].corner, crossed_.second[i].triangle};
            for (std::size_t k = 0; k < 3; ++k) {
                if (const auto* crossings = line(piece.corner, k)) {
                    for (const auto& [skin, opened] : *crossings) {
                        const double height = skin_normal(skin).dot(X(piece, k + 2) - X(piece, k));
                        inside[i] -= height;
                    }
                    continue;
                }
                const auto [known, is_new] = at.try_emplace(Edge(std::minmax(piece.corner[k], piece.corner[(k + 1) % 3])), i);
                if (!is_new) together.join(known->second, i);
            }
        }
        std::vector<double> sum(inside.size(), 0);
        for (std::size_t i = 0; i < inside.size(); ++i) sum[together.root(i)] += inside[i];
        for (std::size_t i = 0; i < inside.size(); ++i) {
            const auto c = std::size_t(crossed_.second[i].triangle);
            const double vote = sum[together.root(i)];
            if (vote != 0 ? vote < 0 : c >= opened_.faces) continue;
            for (int lip = 0; lip < 2; ++lip) {
                const std::int32_t element = opened_.lips[c][std::size_t(lip)].element;
                if (element < 0) continue;
                Piece piece{crossed_.second[i].corner, std::int32_t(c), lip, false, element};
                if (lip == 1) std::swap(piece.corner[1], piece.corner[2]);
                pieces_.push_back(piece);
            }
        }
    }

    /// What joins lips along an edge of theirs: the vertices of the mesh that the edge of their opened face runs between, or the face itself.
    using LipKey = std::array<std::int32_t, 5>;
    LipKey lip_key(const Piece& piece, std::size_t k) {
        const auto [low, high] = std::minmax(piece.corner[k], piece.corner[(k + 1) % 3]);
        const Triangle& t = opened_.surface.triangles[std::size_t(piece.triangle)];
        const auto& vertex = opened_.lips[std::size_t(piece.triangle)][std::size_t(piece.lip)].vertex;
        for (std::size_t e = 0; e < 3; ++e) {
            const Vec3 &a = opened_.surface.vertices[std::size_t(t[e])], along = opened_.surface.vertices[std::size_t(t[(e + 1) % 3])] - a;
            const auto off = [&](std::int32_t p) { return (along.cross(point(p) - a)).norm() / along.norm(); };
            if (std::max(off(low), off(high)) > 4 * kTolerance * opened_.size) continue;
            const auto [from, to] = std::minmax(vertex[e], vertex[(e + 1) % 3]);
            return {low, high, from, to, -1};
        }
        return {low, high, piece.triangle, piece.lip, 0};
    }

    void join() {
        parting_.assign(crossed_.point.size(), 0);  // points at which corners may be several vertices
        for (const auto& [edge, crossings] : crossed_.lines) parting_[std::size_t(edge.first)] = parting_[std::size_t(edge.second)] = 1;
        for (std::size_t i = skin_pieces_; i < pieces_.size(); ++i)
            for (const std::int32_t p : pieces_[i].corner) parting_[std::size_t(p)] = 1;
        corners_.reset(pieces_.size() * 3);
        std::map<Edge, std::size_t> of_skin;
        std::map<LipKey, std::size_t> of_lips;  // also of lips to skin: [edge, triangle of the opened surface, lip, 1]
        const auto meet = [&](auto& known, const auto& key, std::size_t i, std::size_t k) {
            const auto [other, is_new] = known.try_emplace(key, i * 3 + k);
            if (is_new) return;
            const std::size_t j = other->second / 3, m = other->second % 3;
            for (const std::size_t a : {k, (k + 1) % 3})
                for (const std::size_t b : {m, (m + 1) % 3})
                    if (pieces_[i].corner[a] == pieces_[j].corner[b]) corners_.join(i * 3 + a, j * 3 + b);
        };
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            const Piece& piece = pieces_[i];
            if (piece.gone) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(piece.corner[k], piece.corner[(k + 1) % 3]);
                if (!parting_[std::size_t(low)] && !parting_[std::size_t(high)]) continue;
                if (const auto* crossings = line(piece.corner, k)) {
                    if (piece.lip >= 0) {
                        meet(of_lips, LipKey{low, high, piece.triangle, piece.lip, 1}, i, k);
                    } else {
                        for (const auto& [skin, opened] : *crossings) meet(of_lips, LipKey{low, high, opened, side_of(piece, k, opened), 1}, i, k);
                    }
                } else if (piece.lip >= 0) {
                    meet(of_lips, lip_key(piece, k), i, k);
                } else {
                    meet(of_skin, Edge(low, high), i, k);
                }
            }
        }
    }

    /// Points outside of the mesh that are nearest to an element across the cut, though the cut, going on outward, leaves them on this side: bound to the element of their side.
    void take_over() {
        Neighbours neighbours(edit_.mesh);
        std::map<std::int32_t, std::vector<std::size_t>> pieces_at;  // [point not on a line] pieces of the skin near lines
        std::vector<std::size_t> front;
        for (std::size_t i = 0; i < skin_pieces_; ++i)
            if (!pieces_[i].gone && pieces_[i].element >= 0) front.push_back(i);
        std::map<std::size_t, std::int32_t> side;  // [piece]
        for (const std::size_t i : front) side[i] = pieces_[i].element;
        while (!front.empty()) {
            std::vector<std::size_t> next;
            for (const std::size_t i : front)
                for (const std::int32_t p : pieces_[i].corner) {
                    if (parting_[std::size_t(p)] || std::size_t(p) >= was_.size() || taken_.contains(p)) continue;
                    const std::int32_t mine = hosts_.host({&was_[std::size_t(p)], 1}, point(p));
                    if (mine < 0 || mine == side[i] || least_weight(edit_.mesh, mine, point(p)) > -1e-9 || neighbours.joined(side[i], mine)) continue;
                    taken_[p] = side[i];
                    if (pieces_at.empty())
                        for (std::size_t j = 0; j < skin_pieces_; ++j)
                            if (!pieces_[j].gone)
                                for (const std::int32_t q : pieces_[j].corner) pieces_at[q].push_back(j);
                    for (const std::size_t j : pieces_at[p])
                        if (side.try_emplace(j, side[i]).second) next.push_back(j);
                }
            front = std::move(next);
        }
    }

    void name(mesh::TriangleMesh& surface, std::vector<std::int32_t>& element) {
        // A vertex at a line or on a lip is bound to the element of its side that it lies in, or is least outside of.
        std::map<std::size_t, std::pair<double, std::int32_t>> bound;  // [set of corners]
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            if (pieces_[i].gone || pieces_[i].element < 0) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                if (!parting_[std::size_t(pieces_[i].corner[k])]) continue;
                const bool at_line = pieces_[i].lip >= 0 || line(pieces_[i].corner, k) != nullptr || line(pieces_[i].corner, (k + 2) % 3) != nullptr;
                if (!at_line) continue;
                const double least = least_weight(edit_.mesh, pieces_[i].element, X(pieces_[i], k));
                const auto [known, is_new] = bound.try_emplace(corners_.root(i * 3 + k), least, pieces_[i].element);
                if (!is_new && (least > known->second.first + 1e-9 || (least > known->second.first - 1e-9 && pieces_[i].element < known->second.second))) known->second = {least, pieces_[i].element};
            }
        }
        std::map<std::size_t, std::int32_t> of_set;
        std::vector<std::int32_t> of_point(crossed_.point.size(), -1);
        std::map<Edge, std::int32_t> of_stray;  // [point, element] points whose own element is gone
        std::vector<Piece> left;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            const Piece& piece = pieces_[i];
            if (piece.gone) continue;
            Triangle now{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t p = piece.corner[k];
                const auto make = [&](std::int32_t& known, std::int32_t e) {
                    known = std::int32_t(surface.vertices.size());
                    surface.vertices.push_back(point(p));
                    element.push_back(e);
                };
                std::int32_t* known = nullptr;
                if (parting_[std::size_t(p)]) {
                    const std::size_t set = corners_.root(i * 3 + k);
                    known = &of_set.try_emplace(set, -1).first->second;
                    if (*known < 0) {
                        const auto found = bound.find(set);
                        make(*known, found != bound.end() ? found->second.second : own(piece, p));
                    }
                } else {
                    known = &of_point[std::size_t(p)];
                    const auto taken = taken_.find(p);
                    const std::int32_t old = taken != taken_.end()                              ? taken->second
                                             : *known < 0 && std::size_t(p) < was_.size() ? hosts_.host({&was_[std::size_t(p)], 1}, point(p))
                                                                                           : -1;
                    if (*known < 0 && (std::size_t(p) >= was_.size() || old >= 0)) make(*known, old >= 0 ? old : own(piece, p));
                    if (*known < 0) {  // each triangle there has it in an element of its own
                        const std::int32_t e = own(piece, p);
                        known = &of_stray.try_emplace({p, e}, -1).first->second;
                        if (*known < 0) make(*known, e);
                    }
                }
                now[k] = *known;
            }
            surface.triangles.push_back(now);
            left.push_back(piece);
        }
        pieces_ = std::move(left);
    }

    /// The element for a point of a piece of the skin whose side no line tells.
    std::int32_t own(const Piece& piece, std::int32_t p) const {
        if (piece.element >= 0) return piece.element;
        if (std::size_t(p) < was_.size() && hosts_.lives(was_[std::size_t(p)])) return hosts_.host({&was_[std::size_t(p)], 1}, point(p));
        const Triangle& t = skin_.triangles[std::size_t(piece.triangle)];
        return hosts_.host(std::array{was_[std::size_t(t[0])], was_[std::size_t(t[1])], was_[std::size_t(t[2])]}, point(p));
    }

    const mesh::TriangleMesh& skin_;
    std::span<const std::int32_t> was_;
    const MeshEdit& edit_;
    Hosts hosts_;
    mesh::OpenedSurface opened_;
    mesh::CrossedSurfaces crossed_;
    std::vector<Piece> pieces_;
    std::size_t skin_pieces_ = 0;
    std::vector<char> parting_;
    std::map<std::int32_t, std::int32_t> taken_;  ///< [point] the element that it changes to
    DisjointSets corners_;
};

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

std::array<double, 3> barycentric(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = (b - a).cross(c - a);
    const double area = n.squaredNorm();
    if (!(area > 0)) return {1, 0, 0};
    const double v = n.dot((x - a).cross(c - a)) / area, w = n.dot((b - a).cross(x - a)) / area;
    return {1 - v - w, v, w};
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
    SkinCut cut(surface_, embedding_.elements(), before, edit);
    cut.run(out.surface, out.element);
    out.origin = origin();
    const Hosts hosts(before, edit);
    const Mat3 axes = axes_of(cut.opened());
    for (const Piece& piece : cut.pieces()) {
        const auto x = [&](std::size_t k) -> const Vec3& { return cut.point(piece.corner[k]); };
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
                const auto w = barycentric(x(k), surface_.vertices[std::size_t(t[0])], surface_.vertices[std::size_t(t[1])], surface_.vertices[std::size_t(t[2])]);
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
    const Hosts hosts(before, edit);
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
