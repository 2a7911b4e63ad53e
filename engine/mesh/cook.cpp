#include "supple/mesh/cook.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "supple/base/disjoint_sets.h"
#include "supple/base/error.h"
#include "supple/mesh/boundary_fit.h"
#include "supple/mesh/embedding.h"
#include "supple/mesh/lattice_hexes.h"
#include "supple/mesh/manifold.h"
#include "supple/mesh/topology.h"

namespace supple {
namespace {

constexpr double kCrumb = 1e-3;         // of the volume
constexpr double kCountTolerance = 0.05;
constexpr double kLeastCageFill = 0.02; // what an empty tet of a cage weighs and resists
constexpr double kBlock = 4;            // edges: places as large as this are asked for their sign at once
constexpr int kFillDepth = 1, kFillDepthOfFew = 2;  // halvings of what is partly filled; a coarse mesh can afford more, and needs them
constexpr std::size_t kFew = 8000;
constexpr int kCountTries = 9;  // of edges, before the lattice is shifted

/// The parts of a mesh that share vertices: label per tet, volume per label.
struct Parts {
    std::vector<std::int32_t> of_tet;
    std::vector<double> volume_m3;
};

double volume(const VolumeMesh& mesh, const Tet& t) {
    return tet_volume(mesh.vertices[std::size_t(t[0])], mesh.vertices[std::size_t(t[1])], mesh.vertices[std::size_t(t[2])], mesh.vertices[std::size_t(t[3])]);
}

template <class Element>
Parts parts_of(const VolumeMesh& mesh, const std::vector<Element>& elements) {
    DisjointSets sets(mesh.vertices.size());
    for (const Element& e : elements)
        for (const std::int32_t v : e) sets.join(std::size_t(e[0]), std::size_t(v));
    std::vector<std::int32_t> label(mesh.vertices.size(), -1);
    Parts parts;
    for (const Element& e : elements) {
        std::int32_t& l = label[sets.root(std::size_t(e[0]))];
        if (l < 0) {
            l = std::int32_t(parts.volume_m3.size());
            parts.volume_m3.push_back(0);
        }
        parts.of_tet.push_back(l);
        if constexpr (std::is_same_v<Element, Tet>) parts.volume_m3[std::size_t(l)] += volume(mesh, e);
    }
    return parts;
}

std::size_t drop_crumbs(VolumeMesh& mesh) {
    const Parts parts = parts_of(mesh, mesh.tets);
    double sum = 0;
    for (const double v : parts.volume_m3) sum += v;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        if (parts.volume_m3[std::size_t(parts.of_tet[t])] >= kCrumb * sum) mesh.tets[kept++] = mesh.tets[t];
    const std::size_t dropped = mesh.tets.size() - kept;
    mesh.tets.resize(kept);
    if (dropped > 0) drop_unused_vertices(mesh);
    return dropped;
}

/// A lattice: how long its edges are, and where it lies.
struct Lattice {
    double edge_m = 0;
    Vec3 shift = Vec3::Zero();  // in edges
    bool operator==(const Lattice&) const = default;
};

StuffingDef lattice_around(const Box& box, double margin_m, const Lattice& lattice) {
    StuffingDef def;
    def.min_m = box.min_m - Vec3::Constant(margin_m);
    def.max_m = box.max_m + Vec3::Constant(margin_m);
    def.edge_m = lattice.edge_m;
    def.shift = lattice.shift;
    return def;
}

/// Whether every point of the surface and the middle of every triangle's edges lie in the mesh.
bool encloses(const VolumeMesh& mesh, const mesh::TriangleMesh& surface, Team& team) {
    const ElementLocator locator(mesh);
    std::vector<char> open((surface.triangles.size() + 255) / 256, 0);
    team.for_range(surface.triangles.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 &a = surface.vertices[std::size_t(surface.triangles[t][k])], &b = surface.vertices[std::size_t(surface.triangles[t][(k + 1) % 3])];
                if (locator.holding(a) < 0 || locator.holding(0.5 * (a + b)) < 0) {
                    open[begin / 256] = 1;
                    return;
                }
            }
    });
    return std::find(open.begin(), open.end(), 1) == open.end();
}

/// Cooks a region with one lattice or another.
class Cook {
public:
    Cook(const SolidRegion& region, const mesh::TriangleMesh& surface, CookKind kind, Team& team) : region_(region), surface_(surface), kind_(kind), team_(team) {}

    std::size_t count(const Lattice& lattice) {
        if (kind_ == CookKind::hexes) return count_hexes(region_, {.edge_m = lattice.edge_m, .shift = lattice.shift, .depth = 0}, team_);
        make_tets(lattice);
        return mesh_.tets.size();
    }

    VolumeMesh run(const Lattice& lattice, CookReport& report) {
        report.edge_m = lattice.edge_m;
        if (kind_ == CookKind::hexes) return fill_with_hexes(region_, {.edge_m = lattice.edge_m, .shift = lattice.shift}, team_);
        make_tets(lattice);
        report.dropped_tets = dropped_;
        report.stuffing = stuffing_;
        if (kind_ == CookKind::tets) fit_boundary(mesh_, region_, surface_, lattice.edge_m, team_);
        if (kind_ == CookKind::cage) measure_fill();
        return std::move(mesh_);
    }

private:
    void make_tets(const Lattice& lattice) {
        if (lattice == lattice_ && !mesh_.tets.empty()) return;  // the last count
        lattice_ = lattice;
        const double edge_m = lattice.edge_m;
        if (kind_ == CookKind::tets) {
            const FarSigns far(region_, 0, kBlock * edge_m, team_);
            const auto shape = [&](const Vec3& x) { return far.signed_distance(x, edge_m); };
            mesh_ = stuff_isosurface(shape, lattice_around(region_.box(), 0, lattice), &stuffing_, &team_);
            dropped_ = drop_crumbs(mesh_);
            return;
        }
        // The region grown by a margin that is raised until all of the surface is inside. At a hole the distance jumps from one side of zero to the other.
        for (;; margin_ *= 1.3) {
            const double margin = margin_ * edge_m;
            const FarSigns far(region_, margin, kBlock * edge_m, team_);
            const auto shape = [&](const Vec3& x) { return far.signed_distance(x, margin + edge_m) - margin; };
            mesh_ = stuff_isosurface(shape, lattice_around(region_.box(), margin, lattice), &stuffing_, &team_);
            if (encloses(mesh_, surface_, team_)) return;
        }
    }

    void measure_fill() {
        mesh_.fill.resize(mesh_.tets.size());
        const int depth = mesh_.tets.size() < kFew ? kFillDepthOfFew : kFillDepth;
        team_.for_range(mesh_.tets.size(), 32, [&](std::size_t begin, std::size_t end) {
            for (std::size_t e = begin; e < end; ++e) {
                std::array<Vec3, 4> x;
                for (std::size_t a = 0; a < 4; ++a) x[a] = mesh_.vertices[std::size_t(mesh_.tets[e][a])];
                mesh_.fill[e] = std::max(region_.fraction(x, depth), kLeastCageFill);
            }
        });
    }

    const SolidRegion& region_;
    const mesh::TriangleMesh& surface_;
    CookKind kind_;
    Team& team_;
    double margin_ = 0.15;  // of a cage, in edges; what one length needed is where the next begins
    Lattice lattice_;
    VolumeMesh mesh_;
    StuffingReport stuffing_;
    std::size_t dropped_ = 0;
};

/// Finds the lattice that makes so many elements of a shape. Their number has a part that goes with the shape's volume and one that goes with its surface,
/// n = per_cube V / e^3 + b / e^2. b is measured at a coarse lattice; what that cannot see is corrected by the count itself.
class LatticeSearch {
public:
    LatticeSearch(Cook& cook, const SolidRegion& region, double volume_m3, const CookDef& def)
        : cook_(cook), per_volume_((def.kind == CookKind::hexes ? 1 : 12) * volume_m3), wanted_(double(def.elements)), longest_(0.5 * region.box().size().maxCoeff()) {}

    /// A shape whose flat sides lie along the lattice gains or loses a layer at once: its count jumps over the wanted one at every edge. Shifted by parts of an edge that
    /// differ from axis to axis, the lattice meets the sides one after the other.
    Lattice run() {
        static const std::array<Vec3, 5> kShifts{Vec3(0, 0, 0), Vec3(0.25, 0.125, 0.375), Vec3(0.375, 0.25, 0.125), Vec3(0.125, 0.375, 0.25), Vec3(0.3125, 0.0625, 0.1875)};
        for (const Vec3& shift : kShifts) {
            search(shift);
            if (best_miss_ < kCountTolerance) break;
        }
        return best_;
    }

private:
    double edge_for(double n, double b) const {  // n e^3 = per_volume + b e, the larger b the larger e
        double low = 0, high = 10 * std::cbrt(per_volume_ / n) + 10 * std::sqrt(std::max(b, 0.0) / n);
        for (int i = 0; i < 100; ++i) {
            const double e = 0.5 * (low + high);
            (per_volume_ + b * e > n * e * e * e ? low : high) = e;
        }
        return 0.5 * (low + high);
    }

    void search(const Vec3& shift) {
        double edge = best_.edge_m > 0 ? best_.edge_m : std::min(edge_for(std::max(wanted_ / 8, 8.0), 0), longest_);
        double too_short = 0, too_long = 1e300;  // edges that make too many and too few: a count that jumps is closed in upon
        for (int i = 0; i < kCountTries; ++i) {
            const double n = double(cook_.count({edge, shift})), miss = std::abs(std::log(n / wanted_));
            (n > wanted_ ? too_short : too_long) = edge;
            if (miss < best_miss_) {
                best_miss_ = miss;
                best_ = {edge, shift};
            }
            if (best_miss_ < kCountTolerance) return;
            const double b = (n - per_volume_ / (edge * edge * edge)) * edge * edge;
            edge = std::min(b > 0 || i == 0 ? edge_for(wanted_, b) : edge * std::pow(n / wanted_, 1.0 / 3), longest_);
            if (edge <= too_short || edge >= too_long || i > 3) edge = too_short > 0 && too_long < 1e300 ? std::sqrt(too_short * too_long) : edge;
        }
    }

    Cook& cook_;
    double per_volume_, wanted_, longest_;
    double best_miss_ = 1e300;
    Lattice best_;
};

}  // namespace

std::vector<std::string> CookReport::sentences() const {
    std::vector<std::string> out;
    char text[240];
    if (was_inside_out) out.push_back("the surface was inside out (clockwise from outside); it has been turned");
    const double ratio = region_volume_m3 > 0 ? volume_m3 / region_volume_m3 : 1;
    if (std::abs(ratio - 1) > 0.02) {
        // What is lost goes about as the square of the edge where the surface is curved, and slower where thin parts vanish.
        const double shorter = edge_m * std::min(0.9, 0.9 * std::sqrt(0.02 / std::abs(ratio - 1)));
        std::snprintf(text, sizeof text, "the elements hold %.1f %% of the volume inside of the surface: parts thinner than about %.2g m are lost or closed; try --edge-length %.2g",
                      100 * ratio, edge_m, shorter);
        out.emplace_back(text);
    }
    if (dropped_tets > 0) out.push_back(std::to_string(dropped_tets) + " tets in crumbs of less than 1/1000 of the volume were left out");
    if (components > 1) out.push_back("the mesh has " + std::to_string(components) + " parts that do not hang together");
    return out;
}

VolumeMesh cook(const mesh::TriangleMesh& surface, const CookDef& def, Team& team, CookReport* report) {
    const SolidRegion region(surface);
    return cook(region, surface, region.volume(team), def, team, report);
}

VolumeMesh cook(const SolidRegion& region, const mesh::TriangleMesh& surface, double region_volume_m3, const CookDef& def, Team& team, CookReport* report) {
    require_in_range(def.edge_m, 0, 1e6, "CookDef.edge_m", "0 chooses it by the number of elements");
    require_in_range(double(def.elements), 1, double(1 << 28), "CookDef.elements", "");
    if (!(region_volume_m3 > 0))
        throw Error(ErrorCode::invalid_argument, "cook", "the surface encloses nothing: nowhere does it go more than half a time around; close it, or give its sheets a thickness");
    CookReport own;
    Cook at(region, surface, def.kind, team);
    VolumeMesh mesh = at.run(def.edge_m > 0 ? Lattice{.edge_m = def.edge_m} : LatticeSearch(at, region, region_volume_m3, def).run(), own);
    own.region_volume_m3 = region_volume_m3;
    own.was_inside_out = region.was_inside_out();
    own.quality = tet_mesh_quality(mesh);
    own.components = mesh.tets.empty() ? parts_of(mesh, mesh.hexes).volume_m3.size() : parts_of(mesh, mesh.tets).volume_m3.size();
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        const double fill = mesh.fill.empty() ? 1 : mesh.fill[e];
        own.volume_m3 += fill * (e < mesh.tets.size() ? volume(mesh, mesh.tets[e]) : std::pow(own.edge_m, 3));
    }
    mesh.source = "cooked surface at edge " + to_text(own.edge_m) + " m";
    if (report) *report = own;
    return mesh;
}

}  // namespace supple
