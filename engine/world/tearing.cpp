#include "supple/world/tearing.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "supple/fem/element_geometry.h"
#include "supple/mesh/embedding.h"
#include "supple/mesh/topology.h"

namespace supple {

namespace {

struct Candidate {
    std::int32_t vertex;
    double excess;  ///< times what it bears
    Vec3 normal;    ///< of the plane, in the present
};

}  // namespace

TopologyDelta tear_overstressed(World& world, BodyId body, const TearDef& def) {
    if (!(def.strength_pa > 0 && std::isfinite(def.strength_pa))) throw Error(ErrorCode::invalid_argument, "TearDef.strength_pa", to_text(def.strength_pa) + " must be above 0");
    if (def.max_stretch != 0) require_in_range(def.max_stretch, 1, 1e9, "TearDef.max_stretch", "0 leaves it to the stress");
    require_in_range(def.toughness_j_m2, 0, 1e12, "TearDef.toughness_j_m2");
    if (def.most_per_step < 1) throw Error(ErrorCode::invalid_argument, "TearDef.most_per_step", std::to_string(def.most_per_step) + " must be at least 1");
    if (std::holds_alternative<VertexList>(def.where) || std::holds_alternative<ElementList>(def.where))
        throw Error(ErrorCode::invalid_argument, "TearDef.where", "numbers change with every tear; select by box, sphere, capsule or group");
    const VolumeMesh& mesh = world.shape(body).mesh();
    const auto x = world.positions(body);
    const StressField field = world.stress(body, {.directions = true});

    // Elements at each selected vertex.
    std::vector<std::int32_t> number(mesh.vertices.size(), -1);
    const std::vector<std::int32_t> chosen = select_vertices(mesh, def.where);
    for (std::size_t i = 0; i < chosen.size(); ++i) number[std::size_t(chosen[i])] = std::int32_t(i);
    std::vector<std::vector<std::int32_t>> around(chosen.size());
    std::vector<Vec3> stretch(def.max_stretch > 0 ? chosen.size() : 0, Vec3::Zero());  // largest stretch, along it
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
        const auto ids = element_vertices(mesh, e);
        Vec3 most = Vec3::Zero();
        if (!stretch.empty()) {
            const Mat3 F = fem::element_geometry(mesh, e).deformation_gradient(x);
            const Eigen::SelfAdjointEigenSolver<Mat3> b(F * F.transpose());
            most = std::sqrt(std::max(0.0, b.eigenvalues()[2])) * b.eigenvectors().col(2);
        }
        for (const std::int32_t v : ids) {
            const std::int32_t i = number[std::size_t(v)];
            if (i < 0) continue;
            around[std::size_t(i)].push_back(std::int32_t(e));
            if (!stretch.empty() && most.norm() > stretch[std::size_t(i)].norm()) stretch[std::size_t(i)] = most;
        }
    }
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const auto v = std::size_t(chosen[i]);
        const double by_stress = field.principal_pa[v][0] / def.strength_pa, by_stretch = stretch.empty() ? 0 : (stretch[i].norm() - 1) / (def.max_stretch - 1);
        if (!(std::max(by_stress, by_stretch) > 1)) continue;
        candidates.push_back({chosen[i], std::max(by_stress, by_stretch), by_stress >= by_stretch ? Vec3(field.directions[v].col(0)) : Vec3(stretch[i].normalized())});
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.excess != b.excess ? a.excess > b.excess : a.vertex < b.vertex; });

    std::vector<char> waits(mesh.vertices.size(), 0);
    std::vector<ElementFace> faces;
    const auto young = world.element_young_pa(body);
    int torn = 0;
    for (const Candidate& c : candidates) {
        if (torn == def.most_per_step) break;
        if (waits[std::size_t(c.vertex)]) continue;
        const std::vector<std::int32_t>& star = around[std::size_t(number[std::size_t(c.vertex)])];
        std::map<std::array<std::int32_t, 4>, std::pair<ElementFace, bool>> open;  // faces at the vertex: the first element, and its side
        std::vector<ElementFace> here;
        double area = 0, energy = 0;
        for (const std::int32_t e : star) {
            const auto ids = element_vertices(mesh, e);
            Vec3 centre = Vec3::Zero();
            for (const std::int32_t v : ids) centre += x[std::size_t(v)] / double(ids.size());
            const bool front = (centre - x[std::size_t(c.vertex)]).dot(c.normal) > 0;
            const double sigma = std::max(0.0, field.principal_pa[std::size_t(c.vertex)][0]);
            energy += fem::element_geometry(mesh, std::size_t(e)).volume * sigma * sigma / (2 * young[std::size_t(e)]);
            const bool tet = ids.size() == 4;
            for (int f = 0; f < (tet ? 4 : 6); ++f) {
                std::array<std::int32_t, 4> key{-1, -1, -1, -1};
                const std::size_t n = tet ? 3 : 4;
                for (std::size_t k = 0; k < n; ++k) key[k] = ids[std::size_t(tet ? kTetFaces[std::size_t(f)][k] : kHexFaces[std::size_t(f)][k])];
                if (std::find(key.begin(), key.end(), c.vertex) == key.end()) continue;
                const auto X = [&](std::size_t k) -> const Vec3& { return mesh.vertices[std::size_t(key[k])]; };
                const double size = n == 3 ? 0.5 * (X(1) - X(0)).cross(X(2) - X(0)).norm() : 0.5 * (X(2) - X(0)).cross(X(3) - X(1)).norm();
                for (std::size_t i = 1; i < n; ++i)  // four at most: no library sort
                    for (std::size_t k = i; k > 0 && key[k] < key[k - 1]; --k) std::swap(key[k], key[k - 1]);
                const auto [other, is_new] = open.try_emplace(key, std::pair{ElementFace{e, f}, front});
                if (is_new || other->second.second == front) continue;
                here.push_back({e, f});
                area += size;
            }
        }
        if (here.empty() || energy < def.toughness_j_m2 * area) continue;
        faces.insert(faces.end(), here.begin(), here.end());
        ++torn;
        for (const std::int32_t e : star)
            for (const std::int32_t v : element_vertices(mesh, e)) waits[std::size_t(v)] = 1;
    }
    if (faces.empty()) return identity_delta(mesh);
    return world.tear(body, faces);
}

}  // namespace supple
