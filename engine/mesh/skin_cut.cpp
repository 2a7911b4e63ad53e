// A skin and what an edit laid open. What the edit laid open is a surface of faces (mesh/opened_surface), which goes on in walls where it reaches the boundary, for skins a little
// outside of it. Skin and opened surface cut one another (mesh/surface_crossing). A part of the skin at their common line belongs to the element behind the opened face on its side; parts
// of the opened surface within the skin are drawn twice, a lip for each side. Which corners at a point are one vertex is what hangs together around it: across edges that are on
// no line, along a lip from face to face, and across the line from a lip to the skin of its side. So the lips end where they should, and a closed skin stays closed.
// Lips of earlier edits lie on one another at rest. They are moved apart a little while surfaces are cut, so that what lies at one place is what hangs together there.
#include "supple/mesh/skin_cut.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "supple/base/disjoint_sets.h"
#include "supple/mesh/element_neighbours.h"
#include "supple/mesh/moved_lips.h"
#include "supple/mesh/outside_skin.h"
#include "supple/mesh/surface_crossing.h"

namespace supple::mesh {

namespace {

constexpr double kTolerance = 1e-8;   // of the mean edge of the opened faces: nearer points are one
constexpr double kWallHeight = 2;     // in those edges: skins are cut that lie so far outside
constexpr double kLeastWall = 0.02;   // in those edges, where the skin lies on the mesh
constexpr int kSameSide = 3;          // vertices between elements on one side of a cut
constexpr double kFarthest = -1.5;    // least weight by which a point is still bound to an element that it does not lie in

using Edge = std::pair<std::int32_t, std::int32_t>;

/// The skin's triangles that an opened surface may meet: those of elements that the edit changed, or that have a vertex of such.
std::vector<std::int32_t> triangles_near(const TriangleMesh& skin, std::span<const std::int32_t> element, const VolumeMesh& before, const TopologyDelta& delta) {
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

/// [vertex] 1: another one lies at the very same place.
std::vector<char> coinciding(std::span<const Vec3> x) {
    std::vector<std::int32_t> order(x.size());
    std::iota(order.begin(), order.end(), 0);
    const auto at = [&](std::int32_t p) { return std::array{x[std::size_t(p)].x(), x[std::size_t(p)].y(), x[std::size_t(p)].z()}; };
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return at(a) < at(b); });
    std::vector<char> out(x.size(), 0);
    for (std::size_t i = 1; i < order.size(); ++i)
        if (x[std::size_t(order[i])] == x[std::size_t(order[i - 1])]) out[std::size_t(order[i])] = out[std::size_t(order[i - 1])] = 1;
    return out;
}

/// Whether a point of a skin is moved by lips alone.
bool lies_on_lips(const Embedding& embedding, std::size_t p, const MovedLips& moved) {
    for (std::size_t k = p * embedding.corners(); k < (p + 1) * embedding.corners(); ++k)
        if (std::abs(embedding.weights()[k]) > 1e-6 && !moved.on_lip[std::size_t(embedding.vertices()[k])]) return false;
    return true;
}

class SkinCutter {
public:
    SkinCutter(const TriangleMesh& skin, const Embedding& embedding, const VolumeMesh& before, const MeshEdit& edit)
        : skin_(skin), rest_(skin.vertices), was_(embedding.elements()), edit_(edit), hosts_(before, edit), neighbours_(edit.mesh) {
        const std::span<const std::int32_t> was = was_;
        const BoundarySurface boundary = extract_boundary(edit.mesh);
        const MovedLips moved(before), now(moved, edit);
        if (moved.any) {
            std::vector<Vec3> there(skin.vertices.size());
            embedding.deform(moved.x, there);
            const std::vector<char> twice = coinciding(skin.vertices);
            for (std::size_t p = 0; p < there.size(); ++p)
                if (twice[p] || lies_on_lips(embedding, p, moved)) skin_.vertices[p] = there[p];
        }
        const std::vector<std::int32_t> parent = boundary_parents(before, edit);
        std::vector<char> on_lip(parent.size(), 0);
        if (moved.any) {
            const BoundarySurface was_boundary = extract_boundary(before);
            for (std::size_t b = 0; b < parent.size(); ++b) {
                if (parent[b] < 0) continue;
                on_lip[b] = moved.is_lip(before, was_boundary.element[std::size_t(parent[b])], was_boundary.triangles[std::size_t(parent[b])]);
            }
        }
        const std::vector<std::int32_t> near = triangles_near(skin, was, before, edit.delta);
        const OutsideSkin outside(skin, near, embedding, before);
        opened_ = opened_surface(edit, boundary, parent, now.x, on_lip, [&](const Vec3& at, double edge) { return std::min(outside.reach(at) + kLeastWall * edge, kWallHeight * edge); });
        const std::vector<std::int32_t> chosen = opened_.faces > 0 ? near : std::vector<std::int32_t>{};
        crossed_ = cross_surfaces(skin_, chosen, opened_.surface, kTolerance * std::max(opened_.size, 1e-300));
        std::vector<char> is_chosen(skin.triangles.size(), 0);
        for (const std::int32_t t : chosen) is_chosen[std::size_t(t)] = 1;
        for (const auto& part : crossed_.first) pieces_.push_back({part.corner, part.triangle});
        for (std::size_t t = 0; t < is_chosen.size(); ++t)
            if (!is_chosen[t]) pieces_.push_back({skin.triangles[t], std::int32_t(t), -1, false, false});
        std::stable_sort(pieces_.begin(), pieces_.end(), [](const SkinPiece& a, const SkinPiece& b) { return a.triangle < b.triangle; });
        skin_pieces_ = pieces_.size();
        moved_ = now.x;
        find_rest(moved.any);
    }

    SkinCut run() {
        SkinCut out;
        take_sides();
        add_lips();
        join();
        take_over();
        name(out.surface, out.element);
        part_webs(out.surface, out.element);
        out.pieces = std::move(pieces_);
        out.rest = std::move(rest_);
        out.opened = std::move(opened_);
        return out;
    }

private:
    const Vec3& rest(std::int32_t p) const { return rest_[std::size_t(p)]; }
    const Vec3& point(std::int32_t p) const { return crossed_.point[std::size_t(p)]; }
    const Vec3& X(const SkinPiece& piece, std::size_t k) const { return point(piece.corner[k % 3]); }

    /// Where the points lie at rest: as they do in their triangle of the skin, or in the opened one, whose corners are of the mesh.
    void find_rest(bool moved) {
        const std::size_t known = rest_.size();
        rest_.insert(rest_.end(), crossed_.point.begin() + std::ptrdiff_t(known), crossed_.point.end());
        if (!moved) return;
        std::vector<char> done(rest_.size(), 0);
        const auto place = [&](const Triangle& corner, const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to) {
            for (const std::int32_t p : corner) {
                if (std::size_t(p) < known || done[std::size_t(p)]) continue;
                const auto w = barycentric(point(p), from[0], from[1], from[2]);
                rest_[std::size_t(p)] = w[0] * to[0] + w[1] * to[1] + w[2] * to[2];
                done[std::size_t(p)] = 1;
            }
        };
        const auto place_opened = [&](bool walls) {
            for (const auto& part : crossed_.second) {
                if ((std::size_t(part.triangle) >= opened_.faces) != walls) continue;
                const Triangle& t = opened_.surface.triangles[std::size_t(part.triangle)];
                const auto& vertex = opened_.lips[std::size_t(part.triangle)][0].vertex;
                std::array<Vec3, 3> from, to;
                for (std::size_t k = 0; k < 3; ++k) {
                    from[k] = to[k] = opened_.surface.vertices[std::size_t(t[k])];
                    const auto v = std::size_t(vertex[k]), count = edit_.mesh.vertices.size();
                    to[k] += edit_.mesh.vertices[v % count] - moved_[v % count];  // a wall stands on it
                }
                place(part.corner, from, to);
            }
        };
        place_opened(false);
        for (const auto& part : crossed_.first) {
            const Triangle& t = skin_.triangles[std::size_t(part.triangle)];
            std::array<Vec3, 3> from, to;
            for (std::size_t k = 0; k < 3; ++k) {
                from[k] = skin_.vertices[std::size_t(t[k])];
                to[k] = rest_[std::size_t(t[k])];
            }
            place(part.corner, from, to);
        }
        place_opened(true);
    }
    Vec3 normal(std::int32_t opened) const {
        const Triangle& t = opened_.surface.triangles[std::size_t(opened)];
        const auto x = [&](std::size_t k) -> const Vec3& { return opened_.surface.vertices[std::size_t(t[k])]; };
        return (x(1) - x(0)).cross(x(2) - x(0)).normalized();
    }
    /// The pairs of triangles that cross along edge k of a piece; null if none do.
    const std::vector<std::array<std::int32_t, 2>>* line(const Triangle& corner, std::size_t k) const {
        const auto found = crossed_.lines.find(Edge(std::minmax(corner[k], corner[(k + 1) % 3])));
        return found == crossed_.lines.end() ? nullptr : &found->second;
    }
    /// Which lip of an opened triangle a piece of the skin at edge k is on.
    int side_of(const SkinPiece& piece, std::size_t k, std::int32_t opened) const { return normal(opened).dot(X(piece, k + 2) - X(piece, k)) > 0 ? 1 : 0; }

    /// SkinPieces of the skin at a line: the element behind them. Those at a lip that is gone go with it, and all that no line parts from them; where lines do not say, a triangle goes
    /// with two of its corners.
    void take_sides() {
        std::vector<double> stays(skin_pieces_, 0), goes(skin_pieces_, 0);  // lengths of the lines beside it
        std::map<Edge, std::size_t> at;
        DisjointSets together(skin_pieces_);
        for (std::size_t i = 0; i < skin_pieces_; ++i) {
            SkinPiece& piece = pieces_[i];
            for (std::size_t k = 0; k < 3 && piece.looked_at; ++k) {
                if (const auto* crossings = line(piece.corner, k)) {
                    for (const auto& [skin, opened] : *crossings) {
                        const std::int32_t e = opened_.lips[std::size_t(opened)][std::size_t(side_of(piece, k, opened))].element;
                        (e >= 0 ? stays : goes)[i] += (X(piece, k + 1) - X(piece, k)).norm();
                        if (piece.element < 0) piece.element = e;
                    }
                    continue;
                }
                const auto [known, is_new] = at.try_emplace(Edge(std::minmax(piece.corner[k], piece.corner[(k + 1) % 3])), i);
                if (!is_new) together.join(known->second, i);
            }
        }
        std::vector<double> all_stay(skin_pieces_, 0), all_go(skin_pieces_, 0);
        for (std::size_t i = 0; i < skin_pieces_; ++i) {
            all_stay[together.root(i)] += stays[i];
            all_go[together.root(i)] += goes[i];
        }
        for (std::size_t i = 0; i < skin_pieces_; ++i) {
            const double stay = all_stay[together.root(i)], go = all_go[together.root(i)];
            const bool mixed = stay > 0 && go > 0;  // the lines have a gap
            const Triangle& t = skin_.triangles[std::size_t(pieces_[i].triangle)];
            if (stay + go > 0 && !mixed) {
                pieces_[i].gone = go > 0;
            } else if (stays[i] + goes[i] > 0) {
                pieces_[i].gone = goes[i] > stays[i];
            } else {
                pieces_[i].gone = std::count_if(t.begin(), t.end(), [&](std::int32_t p) { return hosts_.lives(was_[std::size_t(p)]); }) < 2;
            }
        }
        shelter();
    }

    /// Pieces that stay though no element of their triangle does (a skin outside of the mesh: the line runs elsewhere than the elements end) belong to an element of the nearest
    /// piece beside them that has one; they go where there is none.
    void shelter() {
        std::map<Edge, std::vector<std::size_t>> at;
        const auto homeless = [&](std::size_t i) {
            const Triangle& t = skin_.triangles[std::size_t(pieces_[i].triangle)];
            return !pieces_[i].gone && pieces_[i].element < 0 && std::none_of(t.begin(), t.end(), [&](std::int32_t p) { return hosts_.lives(was_[std::size_t(p)]); });
        };
        std::vector<std::size_t> without;
        for (std::size_t i = 0; i < skin_pieces_; ++i)
            if (homeless(i)) without.push_back(i);
        if (without.empty()) return;
        for (std::size_t i = 0; i < skin_pieces_; ++i)
            for (std::size_t k = 0; k < 3 && !pieces_[i].gone; ++k)
                if (line(pieces_[i].corner, k) == nullptr) at[std::minmax(pieces_[i].corner[k], pieces_[i].corner[(k + 1) % 3])].push_back(i);
        while (!without.empty()) {
            std::vector<std::pair<std::size_t, std::int32_t>> found;  // of this round: neighbours' order does not matter
            for (const std::size_t i : without) {
                const SkinPiece& piece = pieces_[i];
                const Vec3 middle = (rest(piece.corner[0]) + rest(piece.corner[1]) + rest(piece.corner[2])) / 3;
                std::int32_t best = -1;
                double best_weight = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    if (line(piece.corner, k) != nullptr) continue;
                    for (const std::size_t j : at[std::minmax(piece.corner[k], piece.corner[(k + 1) % 3])]) {
                        if (j == i || homeless(j)) continue;
                        const Triangle& t = skin_.triangles[std::size_t(pieces_[j].triangle)];
                        const std::int32_t e = pieces_[j].element >= 0 ? pieces_[j].element : hosts_.host(std::array{was_[std::size_t(t[0])], was_[std::size_t(t[1])], was_[std::size_t(t[2])]}, middle);
                        const double least = least_weight(edit_.mesh, e, middle);
                        if (best >= 0 && least <= best_weight) continue;
                        best = e;
                        best_weight = least;
                    }
                }
                if (best >= 0) found.emplace_back(i, best);
            }
            if (found.empty()) break;
            for (const auto& [i, e] : found) pieces_[i].element = e;
            std::erase_if(without, [&](std::size_t i) { return pieces_[i].element >= 0; });
        }
        for (const std::size_t i : without) pieces_[i].gone = true;
    }

    /// Angle of a triangle around one of its edges, from the edge's smaller point to the larger: (-pi, pi], from any direction that is the same for all at the edge.
    double angle(const Triangle& corner, std::size_t k) const {
        const auto [low, high] = std::minmax(corner[k], corner[(k + 1) % 3]);
        const Vec3 axis = (point(high) - point(low)).normalized(), to = point(corner[(k + 2) % 3]) - point(low);
        Eigen::Index least = 0;
        axis.cwiseAbs().minCoeff(&least);
        const Vec3 u = axis.cross(Vec3::Unit(least)).normalized(), w = axis.cross(u);
        return std::atan2(w.dot(to), u.dot(to));
    }
    /// Whether the matter behind a triangle lies towards greater angles around edge k.
    static bool matter_follows(const Triangle& corner, std::size_t k) { return corner[k] > corner[(k + 1) % 3]; }

    /// The opened faces within the skin, a piece for each lip: what lies behind the skin's triangles at the lines, and all that hangs together with it.
    void add_lips() {
        std::map<Edge, std::vector<std::pair<double, bool>>> skin_at;  // [line] the skin's triangles there, by angle, and whether matter follows
        for (std::size_t i = 0; i < skin_pieces_; ++i)
            for (std::size_t k = 0; k < 3; ++k)
                if (line(pieces_[i].corner, k) != nullptr)
                    skin_at[std::minmax(pieces_[i].corner[k], pieces_[i].corner[(k + 1) % 3])].emplace_back(angle(pieces_[i].corner, k), matter_follows(pieces_[i].corner, k));
        for (auto& [edge, sheets] : skin_at) std::sort(sheets.begin(), sheets.end());
        DisjointSets together(crossed_.second.size());
        std::vector<double> inside(crossed_.second.size(), 0);
        std::map<Edge, std::size_t> at;
        for (std::size_t i = 0; i < crossed_.second.size(); ++i) {
            const SkinPiece piece{crossed_.second[i].corner, crossed_.second[i].triangle};
            for (std::size_t k = 0; k < 3; ++k) {
                if (line(piece.corner, k) != nullptr) {
                    const auto sheets = skin_at.find(std::minmax(piece.corner[k], piece.corner[(k + 1) % 3]));
                    if (sheets == skin_at.end()) continue;
                    // In front of the next one, round about.
                    auto next = std::upper_bound(sheets->second.begin(), sheets->second.end(), std::pair(angle(piece.corner, k), true));
                    if (next == sheets->second.end()) next = sheets->second.begin();
                    inside[i] += (next->second ? -1 : 1) * (X(piece, k + 1) - X(piece, k)).norm();
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
                SkinPiece piece{crossed_.second[i].corner, std::int32_t(c), lip, false, true, element};
                if (lip == 1) std::swap(piece.corner[1], piece.corner[2]);
                pieces_.push_back(piece);
            }
        }
    }

    /// What joins lips along an edge of theirs: the vertices of the mesh that the edge of their opened face runs between, or the face itself.
    using LipKey = std::array<std::int32_t, 5>;
    LipKey lip_key(const SkinPiece& piece, std::size_t k) {
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
        std::map<LipKey, std::size_t> of_lips;
        const auto unite = [&](std::size_t i, std::size_t k, std::size_t j, std::size_t m) {
            for (const std::size_t a : {k, (k + 1) % 3})
                for (const std::size_t b : {m, (m + 1) % 3})
                    if (pieces_[i].corner[a] == pieces_[j].corner[b]) corners_.join(i * 3 + a, j * 3 + b);
        };
        const auto meet = [&](auto& known, const auto& key, std::size_t i, std::size_t k) {
            const auto [other, is_new] = known.try_emplace(key, i * 3 + k);
            if (!is_new) unite(i, k, other->second / 3, other->second % 3);
        };
        struct Sheet {
            double angle;
            bool matter_follows;
            std::size_t piece, edge;
        };
        std::map<Edge, std::vector<Sheet>> at_line;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            const SkinPiece& piece = pieces_[i];
            if (piece.gone) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(piece.corner[k], piece.corner[(k + 1) % 3]);
                if (!parting_[std::size_t(low)] && !parting_[std::size_t(high)]) continue;
                if (line(piece.corner, k) != nullptr) {
                    at_line[{low, high}].push_back({angle(piece.corner, k), matter_follows(piece.corner, k), i, k});
                } else if (piece.lip >= 0) {
                    meet(of_lips, lip_key(piece, k), i, k);
                } else {
                    meet(of_skin, Edge(low, high), i, k);
                }
            }
        }
        // Around a line: what has matter behind it towards greater angles, and the next one, which has it on the other side. Two lips of a face lie at one angle, their matter apart.
        for (auto& [edge, sheets] : at_line) {
            std::stable_sort(sheets.begin(), sheets.end(), [](const Sheet& a, const Sheet& b) { return a.angle != b.angle ? a.angle < b.angle : a.matter_follows < b.matter_follows; });
            for (std::size_t k = 0; k < sheets.size(); ++k) {
                const Sheet &a = sheets[k], &b = sheets[(k + 1) % sheets.size()];
                if (a.matter_follows && !b.matter_follows) unite(a.piece, a.edge, b.piece, b.edge);
            }
        }
    }

    /// Points outside of the mesh that are nearest to an element across the cut, though the cut, going on outward, leaves them on this side: bound to the element of their side.
    void take_over() {
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
                    const std::int32_t mine = hosts_.host({&was_[std::size_t(p)], 1}, rest(p));
                    if (mine < 0 || mine == side[i] || least_weight(edit_.mesh, mine, rest(p)) > -1e-9 || least_weight(edit_.mesh, side[i], rest(p)) < kFarthest || neighbours_.distance(side[i], mine, kSameSide) <= kSameSide) continue;
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

    void name(TriangleMesh& surface, std::vector<std::int32_t>& element) {
        // A vertex at a line or on a lip is bound to the element of its side that it lies in, or is least outside of.
        // Lips know best: where several faces meet, a piece of the skin may have been told another's.
        std::map<std::size_t, std::pair<double, std::int32_t>> bound;  // [set of corners]
        std::map<std::size_t, bool> by_lip;
        for (std::size_t n = 0; n < pieces_.size(); ++n) {
            const std::size_t i = (n + skin_pieces_) % pieces_.size();
            if (pieces_[i].gone || pieces_[i].element < 0) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                if (!parting_[std::size_t(pieces_[i].corner[k])]) continue;
                const bool at_line = pieces_[i].lip >= 0 || line(pieces_[i].corner, k) != nullptr || line(pieces_[i].corner, (k + 2) % 3) != nullptr;
                if (!at_line) continue;
                const double least = least_weight(edit_.mesh, pieces_[i].element, rest(pieces_[i].corner[k]));
                const auto [known, is_new] = bound.try_emplace(corners_.root(i * 3 + k), least, pieces_[i].element);
                if (is_new) by_lip[known->first] = pieces_[i].lip >= 0;
                if (!is_new && by_lip[known->first] == (pieces_[i].lip >= 0) && (least > known->second.first + 1e-9 || (least > known->second.first - 1e-9 && pieces_[i].element < known->second.second))) known->second = {least, pieces_[i].element};
            }
        }
        std::map<std::size_t, std::int32_t> of_set;
        std::vector<std::int32_t> of_point(crossed_.point.size(), -1);
        std::map<Edge, std::int32_t> of_stray;  // [point, element] points whose own element is gone
        std::vector<SkinPiece> left;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            const SkinPiece& piece = pieces_[i];
            if (piece.gone) continue;
            Triangle now{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t p = piece.corner[k];
                const auto make = [&](std::int32_t& known, std::int32_t e) {
                    known = std::int32_t(surface.vertices.size());
                    surface.vertices.push_back(rest(p));
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
                                             : *known < 0 && std::size_t(p) < was_.size() ? hosts_.host({&was_[std::size_t(p)], 1}, rest(p))
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

    /// Triangles whose corners are near one another and do not hang together near by, because a line had a gap: all go with one side. A crack along the cut is left there, where a web
    /// from lip to lip would be.
    void part_webs(TriangleMesh& surface, std::vector<std::int32_t>& element) {
        constexpr int kDetour = 3;
        const std::vector<std::int32_t> piece = find_pieces(edit_.mesh).of_element;
        const auto ball = [&](std::int32_t e) {
            const auto ids = element_vertices(edit_.mesh, std::size_t(e));
            std::pair<Vec3, double> out(Vec3::Zero(), 0);
            for (const std::int32_t v : ids) out.first += edit_.mesh.vertices[std::size_t(v)] / double(ids.size());
            for (const std::int32_t v : ids) out.second = std::max(out.second, (edit_.mesh.vertices[std::size_t(v)] - out.first).norm());
            return out;
        };
        std::map<Edge, bool> known;
        const auto torn = [&](std::int32_t a, std::int32_t b) {
            if (piece[std::size_t(a)] != piece[std::size_t(b)]) return true;
            if (a == b || share_vertex(a, b)) return false;
            const auto [at, is_new] = known.try_emplace(Edge(std::minmax(a, b)), false);
            if (is_new) {
                const auto [x, r] = ball(a);
                const auto [y, q] = ball(b);
                const int straight = 1 + int((x - y).norm() / (0.5 * (r + q)));
                at->second = neighbours_.distance(a, b, straight + kDetour) > straight + kDetour;
            }
            return at->second;
        };
        std::map<Edge, std::int32_t> parted;  // [vertex, element of the side] its copy there
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            Triangle& t = surface.triangles[i];
            const auto of = [&](std::size_t k) { return piece[std::size_t(element[std::size_t(t[k])])]; };
            if (!pieces_[i].looked_at && of(0) == of(1) && of(1) == of(2)) continue;
            const std::array<std::int32_t, 3> e{element[std::size_t(t[0])], element[std::size_t(t[1])], element[std::size_t(t[2])]};
            const std::array<bool, 3> gap{torn(e[0], e[1]), torn(e[1], e[2]), torn(e[2], e[0])};
            if (!gap[0] && !gap[1] && !gap[2]) continue;
            // The side whose elements reach best to all corners: hardly that of a crumb.
            std::int32_t side = -1;
            double most = 0;
            for (const std::int32_t s : {pieces_[i].element, e[0], e[1], e[2]}) {
                if (s < 0) continue;
                double worst = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const Vec3& x = surface.vertices[std::size_t(t[k])];
                    worst = std::min(worst, least_weight(edit_.mesh, torn(e[k], s) ? neighbours_.nearest(s, x) : e[k], x));
                }
                if (side < 0 || worst > most) side = s, most = worst;
            }
            for (std::size_t k = 0; k < 3; ++k) {
                if (!torn(e[k], side)) continue;
                const std::int32_t v = t[k];
                const auto [copy, is_new] = parted.try_emplace(Edge(v, side), std::int32_t(surface.vertices.size()));
                if (is_new) {
                    const Vec3 x = surface.vertices[std::size_t(v)];
                    surface.vertices.push_back(x);
                    element.push_back(neighbours_.nearest(side, x));
                }
                t[k] = copy->second;
            }
        }
    }
    bool share_vertex(std::int32_t a, std::int32_t b) const {
        const auto u = element_vertices(edit_.mesh, std::size_t(a)), w = element_vertices(edit_.mesh, std::size_t(b));
        return std::any_of(u.begin(), u.end(), [&](std::int32_t v) { return std::find(w.begin(), w.end(), v) != w.end(); });
    }

    /// The element for a point of a piece of the skin whose side no line tells.
    std::int32_t own(const SkinPiece& piece, std::int32_t p) const {
        if (piece.element >= 0) return piece.element;
        if (std::size_t(p) < was_.size() && hosts_.lives(was_[std::size_t(p)])) return hosts_.host({&was_[std::size_t(p)], 1}, rest(p));
        const Triangle& t = skin_.triangles[std::size_t(piece.triangle)];
        return hosts_.host(std::array{was_[std::size_t(t[0])], was_[std::size_t(t[1])], was_[std::size_t(t[2])]}, rest(p));
    }

    TriangleMesh skin_;    ///< earlier lips apart
    std::vector<Vec3> rest_;     ///< [point]
    std::vector<Vec3> moved_;    ///< [vertex of the edited mesh]
    std::span<const std::int32_t> was_;
    const MeshEdit& edit_;
    Hosts hosts_;
    ElementNeighbours neighbours_;
    OpenedSurface opened_;
    CrossedSurfaces crossed_;
    std::vector<SkinPiece> pieces_;
    std::size_t skin_pieces_ = 0;
    std::vector<char> parting_;
    std::map<std::int32_t, std::int32_t> taken_;  ///< [point] the element that it changes to
    DisjointSets corners_;
};

}  // namespace

std::array<double, 3> barycentric(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = (b - a).cross(c - a);
    const double area = n.squaredNorm();
    if (!(area > 0)) return {1, 0, 0};
    const double v = n.dot((x - a).cross(c - a)) / area, w = n.dot((b - a).cross(x - a)) / area;
    return {1 - v - w, v, w};
}

Hosts::Hosts(const VolumeMesh& before, const MeshEdit& edit) : mesh_(edit.mesh), first_(before.element_count() + 1, 0), parts_(edit.delta.element_parent.size()) {
    for (const std::int32_t old : edit.delta.element_parent) ++first_[std::size_t(old) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t e = 0; e < parts_.size(); ++e) parts_[std::size_t(next[std::size_t(edit.delta.element_parent[e])]++)] = std::int32_t(e);
}

std::int32_t Hosts::host(std::span<const std::int32_t> old, const Vec3& x) const {
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

SkinCut cut_skin(const TriangleMesh& skin, const Embedding& embedding, const VolumeMesh& before, const MeshEdit& edit) { return SkinCutter(skin, embedding, before, edit).run(); }

}  // namespace supple::mesh
