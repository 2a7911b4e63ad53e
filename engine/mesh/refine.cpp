#include "supple/mesh/refine.h"

#include <algorithm>
#include <string>

#include "supple/base/error.h"
#include "supple/mesh/topology.h"

namespace supple {
namespace {

constexpr std::size_t kMostElements = std::size_t(1) << 28;

/// New vertices: each the mean of 2 (edge), 4 (face) or 8 (cell) old ones, named by their ascending ids.
class Midpoints {
public:
    using Key = std::array<std::int32_t, 8>;  // ascending, unused ones -1 in front

    template <class Ids>
    static Key key(const Ids& ids) {
        Key k;
        k.fill(-1);
        std::copy(ids.begin(), ids.end(), k.end() - std::ptrdiff_t(ids.size()));
        std::sort(k.begin(), k.end());
        return k;
    }
    void want(const Key& k) { keys_.push_back(k); }
    void number(std::int32_t first) {
        std::sort(keys_.begin(), keys_.end());
        keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
        first_ = first;
    }
    std::int32_t vertex(const Key& k) const { return first_ + std::int32_t(std::lower_bound(keys_.begin(), keys_.end(), k) - keys_.begin()); }
    const std::vector<Key>& keys() const { return keys_; }

private:
    std::vector<Key> keys_;
    std::int32_t first_ = 0;
};

/// The vertex half-way between corners a and b of a tet; a corner itself where they are the same.
template <class Visit>
void for_tet_edges(const Tet& t, Visit&& visit) {
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b) visit(Midpoints::key(std::array{t[a], t[b]}));
}

/// A hex as 3 x 3 x 3 points: the corners between which point (i, j, k), each 0..2, lies.
std::vector<std::int32_t> hex_point(const Hex& h, int i, int j, int k) {
    constexpr std::array<std::array<int, 3>, 8> kCorner{{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}}};
    std::vector<std::int32_t> ids;
    for (std::size_t c = 0; c < 8; ++c)
        if ((i == 1 || i == kCorner[c][0]) && (j == 1 || j == kCorner[c][1]) && (k == 1 || k == kCorner[c][2])) ids.push_back(h[c]);
    return ids;
}

void want_hex_points(const Hex& h, Midpoints& midpoints) {
    for (int n = 0; n < 27; ++n) {
        const auto ids = hex_point(h, n % 3, n / 3 % 3, n / 9);
        if (ids.size() > 1) midpoints.want(Midpoints::key(ids));
    }
}

void append_tets(const Tet& t, const Midpoints& midpoints, std::vector<Tet>& out) {
    for (const auto& part : kTetParts) {
        Tet small{};
        for (std::size_t k = 0; k < 4; ++k) {
            const std::int32_t a = t[std::size_t(part[k][0])], b = t[std::size_t(part[k][1])];
            small[k] = a == b ? a : midpoints.vertex(Midpoints::key(std::array{a, b}));
        }
        out.push_back(small);
    }
}

void append_hexes(const Hex& h, const Midpoints& midpoints, std::vector<Hex>& out) {
    std::array<std::int32_t, 27> point{};
    for (int n = 0; n < 27; ++n) {
        const auto ids = hex_point(h, n % 3, n / 3 % 3, n / 9);
        point[std::size_t(n)] = ids.size() == 1 ? ids[0] : midpoints.vertex(Midpoints::key(ids));
    }
    for (int n = 0; n < 8; ++n) {
        const int i = n & 1, j = n >> 1 & 1, k = n >> 2;
        const auto p = [&](int di, int dj, int dk) { return point[std::size_t(i + di + 3 * (j + dj) + 9 * (k + dk))]; };
        out.push_back({p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0), p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)});
    }
}

template <class T>
std::vector<T> eightfold(const std::vector<T>& values) {
    std::vector<T> out;
    out.reserve(8 * values.size());
    for (const T& value : values) out.insert(out.end(), 8, value);
    return out;
}

/// The corners in an even order in which the diagonal that cuts the octahedron, from the middle of 02 to that of 13, is the shortest of the three.
Tet with_short_diagonal(const std::vector<Vec3>& x, const Tet& t) {
    const std::array<Tet, 3> orders{t, Tet{t[0], t[3], t[1], t[2]}, Tet{t[0], t[2], t[3], t[1]}};
    const auto length = [&](const Tet& o) {
        const auto at = [&](std::size_t k) -> const Vec3& { return x[std::size_t(o[k])]; };
        return (at(0) + at(2) - at(1) - at(3)).squaredNorm();
    };
    return *std::min_element(orders.begin(), orders.end(), [&](const Tet& a, const Tet& b) { return length(a) < length(b); });
}

VolumeMesh refine_once(const VolumeMesh& mesh) {
    Midpoints midpoints;
    for (const Tet& t : mesh.tets) for_tet_edges(t, [&](const Midpoints::Key& key) { midpoints.want(key); });
    for (const Hex& h : mesh.hexes) want_hex_points(h, midpoints);
    midpoints.number(std::int32_t(mesh.vertices.size()));

    VolumeMesh out;
    out.vertices = mesh.vertices;
    for (const Midpoints::Key& key : midpoints.keys()) {
        Vec3 sum = Vec3::Zero();
        int n = 0;
        for (const std::int32_t v : key)
            if (v >= 0) {
                sum += mesh.vertices[std::size_t(v)];
                ++n;
            }
        out.vertices.push_back(sum / n);
    }
    for (const Tet& t : mesh.tets) append_tets(t, midpoints, out.tets);
    for (const Hex& h : mesh.hexes) append_hexes(h, midpoints, out.hexes);
    out.regions = mesh.regions;
    out.element_region = eightfold(mesh.element_region);
    out.fill = eightfold(mesh.fill);
    for (const VertexGroup& group : mesh.groups) {
        VertexGroup fine = group;
        for (std::size_t i = 0; i < midpoints.keys().size(); ++i) {
            const auto& key = midpoints.keys()[i];
            const bool all = std::all_of(key.begin(), key.end(), [&](std::int32_t v) { return v < 0 || std::binary_search(group.vertices.begin(), group.vertices.end(), v); });
            if (all) fine.vertices.push_back(std::int32_t(mesh.vertices.size() + i));
        }
        out.groups.push_back(std::move(fine));
    }
    out.source = mesh.source;
    return out;
}

}  // namespace

VolumeMesh refine(const VolumeMesh& mesh, int times) {
    require_in_range(times, 0, 10, "refine", "each time makes eight elements of one");
    VolumeMesh out = mesh;
    // Only once: from then on Bey's numbering of the parts keeps their shapes.
    if (times > 0)
        for (Tet& t : out.tets) t = with_short_diagonal(out.vertices, t);
    for (int i = 0; i < times; ++i) {
        if (out.element_count() * 8 > kMostElements)
            throw Error(ErrorCode::invalid_argument, "refine",
                        std::to_string(mesh.element_count()) + " elements refined " + std::to_string(times) + " times are more than 2^28; refine fewer times");
        out = refine_once(out);
    }
    return out;
}

}  // namespace supple
