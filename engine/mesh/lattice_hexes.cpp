#include "supple/mesh/lattice_hexes.h"

#include <cmath>
#include <string>

#include "supple/base/disjoint_sets.h"
#include "supple/base/error.h"
#include "supple/mesh/topology.h"

namespace supple {
namespace {

constexpr int kFaceSamples = 4;
constexpr double kBlock = 4;  // edges: places as large as this are asked at once

class HexLattice {
public:
    HexLattice(const SolidRegion& region, const LatticeHexDef& def) : region_(region), def_(def) {
        const auto refuse = [](const std::string& message) { throw Error(ErrorCode::invalid_argument, "LatticeHexDef.edge_m", message); };
        if (!(def.edge_m > 0) || !std::isfinite(def.edge_m)) refuse(to_text(def.edge_m) + " m; give a length > 0");
        require_in_range(def.least_fill, 0, 0.999, "LatticeHexDef.least_fill", "keep the default");
        require_in_range(def.depth, 0, 6, "LatticeHexDef.depth", "keep the default");
        for (int k = 0; k < 3; ++k) require_in_range(def.shift[k], -0.5, 0.5, "LatticeHexDef.shift", "0 centres the lattice");
        double cells = 1;
        for (int k = 0; k < 3; ++k) {
            const double along = std::ceil(region.box().size()[k] / def.edge_m * (1 + 1e-12)) + 1;
            cells *= along;
            if (!(cells <= 1 << 30)) refuse(to_text(def.edge_m) + " m makes more than 2^30 cubes; give a longer edge");
            cells_[k] = static_cast<std::int64_t>(along);
            origin_[k] = region.box().centre()[k] + (def.shift[k] - 0.5 * double(cells_[k])) * def.edge_m;
        }
    }

    std::size_t count_kept(Team& team) {
        measure(team);
        return kept_.size();
    }

    VolumeMesh run(Team& team) {
        measure(team);
        join(team);
        return mesh();
    }

private:
    std::int64_t count() const { return cells_[0] * cells_[1] * cells_[2]; }
    std::array<std::int64_t, 3> cell(std::int64_t id) const { return {id % cells_[0], id / cells_[0] % cells_[1], id / cells_[0] / cells_[1]}; }
    Vec3 corner(const std::array<std::int64_t, 3>& c, int dx, int dy, int dz) const {
        return origin_ + def_.edge_m * Vec3(double(c[0] + dx), double(c[1] + dy), double(c[2] + dz));
    }

    void measure(Team& team) {
        fill_.resize(std::size_t(count()));
        const double radius = 0.5 * std::sqrt(3.0) * def_.edge_m;
        const FarSigns far(region_, radius, kBlock * def_.edge_m, team);
        team.for_range(fill_.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto c = cell(std::int64_t(i));
                const int side = far.side(corner(c, 0, 0, 0) + Vec3::Constant(0.5 * def_.edge_m));
                fill_[i] = side != 0 ? double(side < 0) : region_.fraction(Box{corner(c, 0, 0, 0), corner(c, 1, 1, 1)}, def_.depth);
            }
        });
        number_.assign(fill_.size(), -1);
        for (std::size_t i = 0; i < fill_.size(); ++i)
            if (fill_[i] > 0 && fill_[i] >= def_.least_fill) {
                number_[i] = std::int32_t(kept_.size());
                kept_.push_back(std::int64_t(i));
            }
        if (kept_.empty())
            throw Error(ErrorCode::invalid_argument, "LatticeHexDef.edge_m",
                        "no cube of edge " + to_text(def_.edge_m) + " m is filled; give a shorter edge, or a surface that encloses something");
    }

    /// Whether the region passes through the upper face of a cube across `axis`.
    bool passes(const std::array<std::int64_t, 3>& c, int axis) const {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Vec3 start = corner(c, 0, 0, 0);
        start[axis] += def_.edge_m;
        for (int n = 0; n < kFaceSamples * kFaceSamples; ++n) {
            const int m = (n * 7 + 5) % (kFaceSamples * kFaceSamples);  // from the middle on: mostly the first answers
            Vec3 x = start;
            x[u] += (m % kFaceSamples + 0.5) / kFaceSamples * def_.edge_m;
            x[v] += (m / kFaceSamples + 0.5) / kFaceSamples * def_.edge_m;
            if (region_.inside(x)) return true;
        }
        return false;
    }

    void join(Team& team) {
        joined_.assign(kept_.size(), {});
        const std::array<std::int64_t, 3> stride{1, cells_[0], cells_[0] * cells_[1]};
        team.for_range(kept_.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto c = cell(kept_[i]);
                for (int axis = 0; axis < 3; ++axis) {
                    if (c[std::size_t(axis)] + 1 >= cells_[std::size_t(axis)]) continue;
                    const std::int64_t next = kept_[i] + stride[std::size_t(axis)];
                    if (number_[std::size_t(next)] < 0) continue;
                    const bool full = fill_[std::size_t(kept_[i])] == 1 || fill_[std::size_t(next)] == 1;
                    if (full || passes(c, axis)) joined_[i][std::size_t(axis)] = number_[std::size_t(next)];
                }
            }
        });
    }

    /// Corners of joined cubes are one vertex, numbered as the cubes meet them.
    VolumeMesh mesh() const {
        constexpr std::array<std::array<int, 3>, 8> kCorner{
            {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
        const auto corner_at = [&](const std::array<int, 3>& p) {
            std::int32_t k = 0;
            while (kCorner[std::size_t(k)] != p) ++k;
            return k;
        };
        DisjointSets sets(8 * kept_.size());
        for (std::size_t i = 0; i < kept_.size(); ++i)
            for (int axis = 0; axis < 3; ++axis) {
                const std::int32_t next = joined_[i][std::size_t(axis)];
                if (next < 0) continue;
                for (std::int32_t k = 0; k < 8; ++k) {
                    auto p = kCorner[std::size_t(k)];
                    if (p[std::size_t(axis)] == 0) continue;
                    p[std::size_t(axis)] = 0;
                    sets.join(8 * i + std::size_t(k), std::size_t(8 * next + corner_at(p)));
                }
            }
        VolumeMesh out;
        std::vector<std::int32_t> vertex(8 * kept_.size(), -1);
        for (std::size_t i = 0; i < kept_.size(); ++i) {
            Hex hex{};
            for (std::int32_t k = 0; k < 8; ++k) {
                std::int32_t& v = vertex[sets.root(8 * i + std::size_t(k))];
                if (v < 0) {
                    v = std::int32_t(out.vertices.size());
                    const auto& p = kCorner[std::size_t(k)];
                    out.vertices.push_back(corner(cell(kept_[i]), p[0], p[1], p[2]));
                }
                hex[std::size_t(k)] = v;
            }
            out.hexes.push_back(hex);
            out.fill.push_back(fill_[std::size_t(kept_[i])]);
        }
        return out;
    }

    struct Joined : std::array<std::int32_t, 3> {
        Joined() { fill(-1); }
    };

    const SolidRegion& region_;
    const LatticeHexDef& def_;
    Vec3 origin_ = Vec3::Zero();
    std::array<std::int64_t, 3> cells_{};
    std::vector<double> fill_;          // per cell of the box
    std::vector<std::int32_t> number_;  // per cell: which kept one
    std::vector<std::int64_t> kept_;
    std::vector<Joined> joined_;        // per kept cube: the next one along x, y, z that it is joined with
};

}  // namespace

std::size_t count_hexes(const SolidRegion& region, const LatticeHexDef& def, Team& team) { return HexLattice(region, def).count_kept(team); }

VolumeMesh fill_with_hexes(const SolidRegion& region, const LatticeHexDef& def, Team& team) { return HexLattice(region, def).run(team); }

}  // namespace supple
