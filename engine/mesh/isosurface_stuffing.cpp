// Isosurface stuffing after F. Labelle and J. R. Shewchuk, "Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles",
// ACM Transactions on Graphics 26(3), 2007. In four passes over a body-centred cubic lattice:
//   1. the shape's value at every lattice point: inside (< 0), outside (> 0) or on the surface (0);
//   2. the cut point of every lattice edge whose ends differ strictly;
//   3. a lattice point with a cut point nearer than alpha x edge moves there and is then on the surface; its other cuts are void;
//   4. every lattice tet is replaced by what lies inside of it, with the cut points as new vertices.
//
// The stencils of pass 4, with a b .. the inside vertices, and ac the cut point on the edge from a to c:
//   no vertex outside: the tet itself.                 one inside: one tet, outside vertices replaced by cut points.
//   two inside, one outside, one on the surface: a pyramid over the quadrilateral a b bc ac.
//   two inside, two outside: a prism (a ac ad | b bc bd).      three inside, one outside: a prism (a b c | ad bd cd).
// A quadrilateral a b bc ac lies in the lattice face a b c and is shared with the next tet, so its diagonal must follow from the face
// alone. Cut edges of different length: the diagonal ends at the cut point of the long edge. Both short (then a b is long, and c
// belongs to the other sublattice): the diagonal starts from that one of a and b which has an even number of coordinates greater
// than c's: a and b differ in one coordinate, on both sides of c's, so this is exactly one. A prism falls into three tets unless
// its three diagonals start from three different vertices of one end. That cannot happen to three-inside prisms (long-edge diagonals
// share their cut point); the free quadrilateral ac bc bd ad of a two-inside prism lies on the surface and takes the valid diagonal
// with the better angles.
#include "supple/mesh/isosurface_stuffing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/parallel.h"
#include "supple/mesh/bcc_lattice.h"
#include "supple/mesh/manifold.h"
#include "supple/mesh/quality.h"

namespace supple {
namespace {

using Point = BccLattice::Point;

constexpr double kWorstMin_deg = 8.9, kWorstMax_deg = 158.8;

[[noreturn]] void refuse(const char* where, const std::string& message) { throw Error(ErrorCode::invalid_argument, where, message); }

BccLattice make_lattice(const StuffingDef& def) {
    require_in_range(def.alpha_long, 1e-3, 0.499, "StuffingDef.alpha_long", "keep the default");
    require_in_range(def.alpha_short, 1e-3, 0.499, "StuffingDef.alpha_short", "keep the default");
    for (int k = 0; k < 3; ++k) require_in_range(def.shift[k], -0.5, 0.5, "StuffingDef.shift", "0 centres the lattice in the box");
    if (!(def.edge_m > 0) || !std::isfinite(def.edge_m)) refuse("StuffingDef.edge_m", to_text(def.edge_m) + " m; give a length > 0");
    BccLattice lattice;
    lattice.edge = def.edge_m;
    double points = 2;
    std::array<double, 3> cells{};
    for (int k = 0; k < 3; ++k) {
        const double extent = def.max_m[k] - def.min_m[k];
        if (!(extent > 0) || !std::isfinite(extent))
            refuse("StuffingDef.max_m", std::string(1, "xyz"[k]) + " runs from " + to_text(def.min_m[k]) + " to " + to_text(def.max_m[k]) +
                                            " m; give finite min < max");
        cells[k] = std::ceil(extent / def.edge_m) + 3;  // a free layer of cells on every side, and room to centre and shift the lattice
        points *= cells[k] + 1;
    }
    if (!(points <= 1 << 30))
        refuse("StuffingDef.edge_m", to_text(def.edge_m) + " m needs a lattice of " + to_text(points) +
                                         " points; at most 2^30, give a longer edge or a smaller box");
    for (int k = 0; k < 3; ++k) {
        lattice.cells[k] = static_cast<int>(cells[k]);
        lattice.origin[k] = 0.5 * (def.min_m[k] + def.max_m[k]) + (def.shift[k] - 0.5 * lattice.cells[k]) * def.edge_m;
    }
    return lattice;
}

class Stuffer {
public:
    Stuffer(ImplicitShape shape, const StuffingDef& def, Team& team) : shape_(shape), def_(def), team_(team), lattice_(make_lattice(def)) {}

    VolumeMesh run(StuffingReport& report) {
        evaluate_points();
        find_cuts();
        warp_points();
        fill();
        report.evaluations = evaluations_;
        report.filled_tets = filled_;
        return std::move(mesh_);
    }

private:
    struct Cut {
        std::int64_t key;          // owner point * 7 + half direction, ascending
        double fraction;           // from the owner
        std::int32_t vertex = -1;  // of the output, once used
    };
    struct Corner {
        Point point;
        std::int64_t id;
        double value;
    };
    using Prism = std::array<std::int32_t, 3>;

    /// What a chunk of a loop over lattice points found; nothing may be thrown inside of one.
    struct Findings {
        std::int64_t evaluations = 0;
        std::optional<Vec3> not_a_number;
        std::vector<Cut> cuts;
    };

    double evaluate(const Vec3& x, Findings& findings) const {
        ++findings.evaluations;
        const double value = shape_(x);
        if (std::isnan(value) && !findings.not_a_number) findings.not_a_number = x;
        return value;
    }

    /// Runs visit(point id, findings) for all lattice points; chunks and the order of what they find do not depend on the team.
    template <class Visit>
    std::vector<Findings> for_points(Visit&& visit) {
        constexpr std::size_t kGrain = 512;
        const auto points = static_cast<std::size_t>(lattice_.points());
        std::vector<Findings> findings((points + kGrain - 1) / kGrain);
        team_.for_range(points, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) visit(static_cast<std::int64_t>(i), findings[begin / kGrain]);
        });
        for (const Findings& f : findings) take(f);
        return findings;
    }

    void take(const Findings& f) {
        evaluations_ += f.evaluations;
        if (!f.not_a_number) return;
        const Vec3& x = *f.not_a_number;
        refuse("stuff_isosurface", "the shape is not a number at (" + to_text(x.x()) + ", " + to_text(x.y()) + ", " + to_text(x.z()) +
                                       ") m; it must have a sign everywhere in the box");
    }

    void evaluate_points() {
        value_.resize(lattice_.points());
        for_points([&](std::int64_t i, Findings& findings) { value_[i] = evaluate(lattice_.position(lattice_.point(i)), findings); });
        bool any_inside = false;
        for (std::int64_t i = 0; i < lattice_.points(); ++i) {
            if (value_[i] > 0) continue;
            const Point p = lattice_.point(i);
            const Vec3 x = lattice_.position(p);
            if (lattice_.on_rim(p))
                refuse("StuffingDef.max_m", "the shape reaches beyond the box, to (" + to_text(x.x()) + ", " + to_text(x.y()) + ", " +
                                                to_text(x.z()) + ") m; give a box that holds it all (and negative values inside only)");
            any_inside = any_inside || value_[i] < 0;
        }
        if (!any_inside)
            refuse("StuffingDef.edge_m", "no lattice point is inside the shape at edge " + to_text(def_.edge_m) +
                                             " m; give a shorter edge (and negative values inside)");
    }

    /// Where the shape changes sign between x0 (value f0) and x1 (value f1): fraction of the way, in (0, 1). False position; an end
    /// that stays has its value halved (Illinois), and three steps that leave more than half of the bracket are followed by a
    /// bisection, so that jumps converge too.
    double find_root(const Vec3& x0, double f0, const Vec3& x1, double f1, Findings& findings) const {
        const bool negative_first = f0 < 0;
        const double largest = std::max(std::abs(f0), std::abs(f1)), accept = std::isfinite(largest) ? 1e-12 * largest : 0;
        double lo = 0, hi = 1;
        int moved = 0, slow_steps = 0;
        for (int i = 0; i < 120 && hi - lo > 1e-9; ++i) {
            const double width = hi - lo;
            double t = lo + width * (f0 / (f0 - f1));
            if (slow_steps >= 3 || !(t > lo && t < hi)) t = 0.5 * (lo + hi);
            const double f = evaluate(x0 + t * (x1 - x0), findings);
            if (std::isnan(f) || std::abs(f) <= accept) return t;
            if ((f < 0) == negative_first) {
                lo = t;
                f0 = f;
                if (moved == -1) f1 *= 0.5;
                moved = -1;
            } else {
                hi = t;
                f1 = f;
                if (moved == 1) f0 *= 0.5;
                moved = 1;
            }
            slow_steps = hi - lo > 0.5 * width ? slow_steps + 1 : 0;
        }
        return 0.5 * (lo + hi);
    }

    void find_cuts() {
        const std::vector<Findings> findings = for_points([&](std::int64_t i, Findings& found) {
            if (value_[i] == 0) return;
            const Point p = lattice_.point(i);
            for (int d = 0; d < BccLattice::kDirections; d += 2) {
                const Point q = BccLattice::neighbour(p, d);
                if (!lattice_.contains(q)) continue;
                const double other = value_[lattice_.id(q)];
                if (other == 0 || (value_[i] < 0) == (other < 0)) continue;
                found.cuts.push_back({7 * i + d / 2, find_root(lattice_.position(p), value_[i], lattice_.position(q), other, found)});
            }
        });
        for (const Findings& f : findings) cuts_.insert(cuts_.end(), f.cuts.begin(), f.cuts.end());
    }

    /// The cut on the edge from p in a direction, or none; `from_p` is its fraction seen from p.
    Cut* find_cut(const Point& p, int direction, double& from_p) {
        const bool owner = (direction & 1) == 0;
        const Point first = owner ? p : BccLattice::neighbour(p, direction);
        if (!lattice_.contains(first)) return nullptr;
        const std::int64_t key = 7 * lattice_.id(first) + direction / 2;
        const auto it = std::lower_bound(cuts_.begin(), cuts_.end(), key, [](const Cut& c, std::int64_t k) { return c.key < k; });
        if (it == cuts_.end() || it->key != key) return nullptr;
        from_p = owner ? it->fraction : 1 - it->fraction;
        return &*it;
    }

    static int direction_between(const Point& p, const Point& q) {
        for (int d = 0; d < BccLattice::kDirections; ++d)
            if (BccLattice::neighbour(p, d) == q) return d;
        return -1;
    }

    void warp_points() {
        std::vector<std::int64_t> near;
        for (const Cut& c : cuts_) {
            const std::int64_t owner = c.key / 7;
            near.push_back(owner);
            near.push_back(lattice_.id(BccLattice::neighbour(lattice_.point(owner), 2 * static_cast<int>(c.key % 7))));
        }
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        for (const std::int64_t i : near) {
            const Point p = lattice_.point(i);
            double nearest = 2;
            Vec3 target = Vec3::Zero();
            for (int d = 0; d < BccLattice::kDirections; ++d) {
                const bool is_long = d < BccLattice::kLongDirections;
                double s = 0;
                const Cut* cut = find_cut(p, d, s);
                if (!cut || s >= (is_long ? def_.alpha_long : def_.alpha_short)) continue;
                const Point q = BccLattice::neighbour(p, d);
                if (value_[lattice_.id(q)] == 0) continue;  // void: that end has moved onto the surface
                const double distance = s * (is_long ? 1.0 : std::sqrt(0.75));
                if (distance >= nearest) continue;
                nearest = distance;
                target = lattice_.position(p) + s * (lattice_.position(q) - lattice_.position(p));
            }
            if (nearest > 1) continue;
            warped_.emplace_back(i, target);
            value_[i] = 0;
        }
    }

    Vec3 point_position(const Corner& c) const {
        if (c.value == 0) {
            const auto it =
                std::lower_bound(warped_.begin(), warped_.end(), c.id, [](const auto& w, std::int64_t id) { return w.first < id; });
            if (it != warped_.end() && it->first == c.id) return it->second;
        }
        return lattice_.position(c.point);
    }

    std::int32_t add_vertex(const Vec3& x) {
        mesh_.vertices.push_back(x);
        return static_cast<std::int32_t>(mesh_.vertices.size()) - 1;
    }

    std::int32_t point_vertex(const Corner& c) {
        std::int32_t& v = point_vertex_[c.id];
        if (v < 0) v = add_vertex(point_position(c));
        return v;
    }

    std::int32_t cut_vertex(const Corner& a, const Corner& b) {
        double s = 0;
        Cut* cut = find_cut(a.point, direction_between(a.point, b.point), s);
        if (cut->vertex < 0)
            cut->vertex = add_vertex(lattice_.position(a.point) + s * (lattice_.position(b.point) - lattice_.position(a.point)));
        return cut->vertex;
    }

    double volume(const Tet& t) const {
        return tet_volume(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]], mesh_.vertices[t[3]]);
    }

    void emit(Tet t) {
        if (volume(t) < 0) std::swap(t[2], t[3]);
        mesh_.tets.push_back(t);
    }

    /// True if the quadrilateral a b bc ac is cut from a to bc, false if from b to ac.
    static bool diagonal_from_a(const Corner& a, const Corner& b, const Corner& c) {
        const bool ac_long = BccLattice::is_centre(a.point) == BccLattice::is_centre(c.point);
        const bool bc_long = BccLattice::is_centre(b.point) == BccLattice::is_centre(c.point);
        if (ac_long != bc_long) return bc_long;
        int greater = 0;
        for (int k = 0; k < 3; ++k) greater += a.point[k] > c.point[k];
        return greater % 2 == 0;
    }

    /// Splits the prism with ends A and B along the diagonals of its sides (0,1), (1,2), (2,0): from_first[i] means from A of the
    /// side's first lateral edge to B of its second. False if the three do not fit together.
    static bool split_prism(const Prism& A, const Prism& B, const std::array<bool, 3>& from_first, std::array<Tet, 3>& out) {
        std::array<int, 3> starts{};  // diagonals that start from each vertex of A
        for (int i = 0; i < 3; ++i) ++starts[from_first[i] ? i : (i + 1) % 3];
        const auto top = std::find(starts.begin(), starts.end(), 2);
        if (top == starts.end()) return false;
        const int p = static_cast<int>(top - starts.begin());
        const int r = static_cast<int>(std::find(starts.begin(), starts.end(), 1) - starts.begin());
        const int q = 3 - p - r;  // both diagonals of this lateral edge end at its B
        out = {Tet{A[p], B[0], B[1], B[2]}, Tet{A[0], A[1], A[2], B[q]}, Tet{A[p], A[r], B[r], B[q]}};
        return true;
    }

    double worst_angle(const std::array<Tet, 3>& tets) const {
        double worst = 180;
        for (const Tet& t : tets) {
            const TetQuality q = tet_quality(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]], mesh_.vertices[t[3]]);
            worst = std::min({worst, q.min_dihedral_deg, (180 - q.max_dihedral_deg)});
        }
        return worst;
    }

    void emit_two_inside(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
        const std::int32_t va = point_vertex(a), vb = point_vertex(b), ac = cut_vertex(a, c), bc = cut_vertex(b, c);
        const bool from_a = diagonal_from_a(a, b, c);
        if (d.value == 0) {
            const std::int32_t vd = point_vertex(d);
            emit({va, vb, from_a ? bc : ac, vd});
            emit({from_a ? va : vb, bc, ac, vd});
            return;
        }
        const Prism A{va, ac, cut_vertex(a, d)}, B{vb, bc, cut_vertex(b, d)};
        const bool side_d = diagonal_from_a(a, b, d);  // side (2, 0): its first lateral edge is the one of d
        std::array<Tet, 3> tets{}, other{};
        const bool fits = split_prism(A, B, {from_a, false, !side_d}, tets);
        const bool other_fits = split_prism(A, B, {from_a, true, !side_d}, other);
        if (!fits || (other_fits && worst_angle(other) > worst_angle(tets))) tets = other;
        for (const Tet& t : tets) emit(t);
    }

    void emit_three_inside(const std::array<Corner, 4>& in, const Corner& d) {
        const Prism A{point_vertex(in[0]), point_vertex(in[1]), point_vertex(in[2])};
        const Prism B{cut_vertex(in[0], d), cut_vertex(in[1], d), cut_vertex(in[2], d)};
        std::array<Tet, 3> tets{};
        split_prism(A, B, {diagonal_from_a(in[0], in[1], d), diagonal_from_a(in[1], in[2], d), diagonal_from_a(in[2], in[0], d)}, tets);
        for (const Tet& t : tets) emit(t);
    }

    void fill_on_surface(const std::array<Corner, 4>& on) {
        std::array<Vec3, 4> x;
        for (int i = 0; i < 4; ++i) x[i] = point_position(on[i]);
        const TetQuality q = tet_quality(x[0], x[1], x[2], x[3]);
        if (q.min_dihedral_deg < kWorstMin_deg || q.max_dihedral_deg > kWorstMax_deg) return;
        Findings findings;
        const double value = evaluate(0.25 * (x[0] + x[1] + x[2] + x[3]), findings);
        take(findings);
        if (value >= 0) return;
        emit({point_vertex(on[0]), point_vertex(on[1]), point_vertex(on[2]), point_vertex(on[3])});
        ++filled_;
    }

    void fill_tet(const std::array<Point, 4>& points) {
        std::array<Corner, 4> in, on, out;
        int n_in = 0, n_on = 0, n_out = 0;
        for (const Point& p : points) {
            const std::int64_t id = lattice_.id(p);
            const double value = value_[id];
            (value < 0 ? in[n_in++] : value > 0 ? out[n_out++] : on[n_on++]) = Corner{p, id, value};
        }
        if (n_in == 0) {
            if (n_on == 4) fill_on_surface(on);
        } else if (n_out == 0) {
            std::copy(on.begin(), on.begin() + n_on, in.begin() + n_in);
            emit({point_vertex(in[0]), point_vertex(in[1]), point_vertex(in[2]), point_vertex(in[3])});
        } else if (n_in == 1) {
            Tet t{point_vertex(in[0]), -1, -1, -1};
            int k = 1;
            for (int i = 0; i < n_on; ++i) t[k++] = point_vertex(on[i]);
            for (int i = 0; i < n_out; ++i) t[k++] = cut_vertex(in[0], out[i]);
            emit(t);
        } else if (n_in == 2) {
            emit_two_inside(in[0], in[1], out[0], n_out == 2 ? out[1] : on[0]);
        } else {
            emit_three_inside(in, out[0]);
        }
    }

    /// The four tets around every long edge between two adjacent centres.
    void fill() {
        point_vertex_.assign(lattice_.points(), -1);
        for (std::int64_t i = lattice_.corners(); i < lattice_.points(); ++i) {
            const Point c = lattice_.point(i);
            for (int axis = 0; axis < 3; ++axis) {
                const Point next = BccLattice::neighbour(c, 2 * axis);
                if (!lattice_.contains(next)) continue;
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                const auto corner = [&](int du, int dv) {
                    Point p = c;
                    p[axis] += 1;
                    p[u] += du;
                    p[v] += dv;
                    return p;
                };
                constexpr std::array<std::array<int, 2>, 4> round{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
                for (int k = 0; k < 4; ++k)
                    fill_tet({corner(round[k][0], round[k][1]), corner(round[(k + 1) % 4][0], round[(k + 1) % 4][1]), c, next});
            }
        }
    }

    ImplicitShape shape_;
    const StuffingDef& def_;
    Team& team_;
    BccLattice lattice_;
    std::vector<double> value_;                          // per lattice point; 0 once it lies on the surface
    std::vector<Cut> cuts_;                              // ascending by key
    std::vector<std::pair<std::int64_t, Vec3>> warped_;  // ascending by point
    std::vector<std::int32_t> point_vertex_;
    VolumeMesh mesh_;
    std::int64_t evaluations_ = 0;
    std::size_t filled_ = 0;
};

}  // namespace

VolumeMesh stuff_isosurface(ImplicitShape shape, const StuffingDef& def, StuffingReport* report, Team* team) {
    StuffingReport own;
    Team alone;
    VolumeMesh mesh = Stuffer(shape, def, team ? *team : alone).run(own);
    const ManifoldReport repair = make_boundary_manifold(mesh);
    own.split_vertices = repair.split_vertices;
    own.removed_tets = repair.removed_tets;
    if (mesh.tets.empty())
        refuse("StuffingDef.edge_m", "nothing solid is left of the shape at edge " + to_text(def.edge_m) + " m; give a shorter edge");
    mesh.source = "implicit shape at edge " + to_text(def.edge_m) + " m";
    if (report) *report = own;
    return mesh;
}

}  // namespace supple
