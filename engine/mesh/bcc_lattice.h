#pragma once
#include <array>
#include <cstdint>

#include "supple/math/types.h"

namespace supple {

/// A body-centred cubic lattice over nx x ny x nz cubes: their corners and their centres. Points are addressed by doubled integer
/// coordinates: all even for a corner, all odd for a centre. Long edges join neighbours of the same kind (length `edge`), short
/// ones a corner and a centre (0.87 edge); every tetrahedron has two opposite long edges and four short ones, all tetrahedra are
/// congruent, and four of them surround the long edge between two adjacent centres.
struct BccLattice {
    using Point = std::array<int, 3>;  ///< doubled coordinates

    static constexpr int kDirections = 14;
    static constexpr int kLongDirections = 6;  ///< directions 0..5 are long edges; d and d ^ 1 are opposite
    static constexpr std::array<Point, kDirections> kOffsets{{{2, 0, 0},
                                                              {-2, 0, 0},
                                                              {0, 2, 0},
                                                              {0, -2, 0},
                                                              {0, 0, 2},
                                                              {0, 0, -2},
                                                              {1, 1, 1},
                                                              {-1, -1, -1},
                                                              {1, 1, -1},
                                                              {-1, -1, 1},
                                                              {1, -1, 1},
                                                              {-1, 1, -1},
                                                              {1, -1, -1},
                                                              {-1, 1, 1}}};

    Vec3 origin = Vec3::Zero();
    double edge = 1;
    std::array<int, 3> cells{1, 1, 1};

    std::int64_t corners() const { return static_cast<std::int64_t>(cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1); }
    std::int64_t points() const { return corners() + static_cast<std::int64_t>(cells[0]) * cells[1] * cells[2]; }

    static bool is_centre(const Point& p) { return (p[0] & 1) != 0; }

    bool contains(const Point& p) const {
        for (int k = 0; k < 3; ++k)
            if (p[k] < 0 || p[k] > 2 * cells[k]) return false;
        return true;
    }

    /// Corners first, then centres, x fastest.
    std::int64_t id(const Point& p) const {
        const std::int64_t i = p[0] >> 1, j = p[1] >> 1, k = p[2] >> 1;
        return is_centre(p) ? corners() + i + cells[0] * (j + cells[1] * k) : i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
    }

    Point point(std::int64_t id) const {
        const int odd = id >= corners() ? 1 : 0;
        if (odd) id -= corners();
        const int nx = cells[0] + 1 - odd, ny = cells[1] + 1 - odd;
        return {2 * static_cast<int>(id % nx) + odd, 2 * static_cast<int>(id / nx % ny) + odd, 2 * static_cast<int>(id / nx / ny) + odd};
    }

    /// True for the outermost layer of corners and of centres.
    bool on_rim(const Point& p) const {
        for (int k = 0; k < 3; ++k)
            if (p[k] <= 1 || p[k] >= 2 * cells[k] - 1) return true;
        return false;
    }

    Vec3 position(const Point& p) const { return origin + 0.5 * edge * Vec3(p[0], p[1], p[2]); }

    static Point neighbour(const Point& p, int direction) {
        const Point& o = kOffsets[direction];
        return {p[0] + o[0], p[1] + o[1], p[2] + o[2]};
    }
};

}  // namespace supple
