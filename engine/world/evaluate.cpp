#include "supple/world/evaluate.h"

#include "supple/base/error.h"
#include "supple/fem/element_passes.h"
#include "supple/fem/elements.h"
#include "supple/fem/rest.h"
#include "supple/fem/stress.h"
#include "supple/world/template_data.h"

namespace supple {

namespace {

/// One configuration of a shape: elements, rotations, scratch. The scalar kernels: an evaluation is a reference, not a race.
struct Configuration {
    Configuration(const BodyTemplate& shape, const Material& material, std::span<const Vec3> positions, Tangent tangent = Tangent::automatic)
        : data(shape.data()) {
        check(positions, "positions_m");
        fem::ElementsDef def;
        def.rest = &data.rest;
        def.corners = &data.corners;
        def.project = false;
        def.exact_rotation = tangent == Tangent::exact;
        check_material(material, data.rest.elements);
        fem::ElementMaterials materials;
        materials.list = {material};
        elements = fem::make_elements(def, materials);
        quaternion.resize(data.rest.blocks() * 4 * fem::kBlock);
        corner.resize(data.rest.blocks() * fem::kBlock * 16);
        fem::seed_rotations(team, data.rest, positions, quaternion);
    }

    void check(std::span<const Vec3> field, const char* what) const {
        if (field.size() != data.rest.vertices) {
            throw Error(ErrorCode::invalid_argument, what,
                        std::to_string(field.size()) + " vectors for a mesh of " + std::to_string(data.rest.vertices) + " vertices");
        }
        for (std::size_t i = 0; i < field.size(); ++i) {
            if (!field[i].allFinite()) throw Error(ErrorCode::invalid_argument, what, "vector " + std::to_string(i) + " is not finite");
        }
    }

    const TemplateData& data;
    Team team;
    std::unique_ptr<fem::Elements> elements;
    AlignedVector<double> quaternion, corner;
};

}  // namespace

Evaluation evaluate(const BodyTemplate& shape, const Material& material, std::span<const Vec3> positions_m) {
    Configuration c(shape, material, positions_m);
    const std::size_t elements = c.data.rest.elements;
    AlignedVector<double> energy(c.data.rest.blocks() * fem::kBlock), stress(c.data.rest.blocks() * 6 * fem::kBlock);
    fem::ElementOutputs outputs;
    outputs.corner_force = c.corner.data();
    outputs.energy = energy.data();
    outputs.stress = stress.data();
    c.elements->evaluate(c.team, positions_m.data()->data(), c.quaternion.data(), outputs);

    Evaluation result;
    result.forces_n.resize(positions_m.size());
    fem::gather(c.team, c.data.corners, c.corner, result.forces_n);
    for (const double w : energy) result.energy_j += w;
    result.element_stress_pa.resize(elements);
    for (std::size_t e = 0; e < elements; ++e) {
        for (std::size_t k = 0; k < 6; ++k) result.element_stress_pa[e][k] = stress[(e / fem::kBlock * 6 + k) * fem::kBlock + e % fem::kBlock];
    }
    result.vertex_stress_pa.resize(positions_m.size());
    for (std::size_t v = 0; v < positions_m.size(); ++v) {
        result.vertex_stress_pa[v] = fem::recover_at_vertex(c.data.corners, c.data.rest.volume, result.element_stress_pa, v);
    }
    return result;
}

std::vector<Vec3> force_differential(const BodyTemplate& shape, const Material& material, std::span<const Vec3> positions_m,
                                     std::span<const Vec3> direction_m, Tangent tangent) {
    const auto* corotational = std::get_if<Corotational>(&material);
    if (tangent == Tangent::exact && corotational != nullptr && corotational->rotation == Rotation::large) {
        throw Error(ErrorCode::invalid_argument, "tangent", "exact goes with rotation polar or svd; the frame of edges (large) is not a function of F alone: take warped");
    }
    Configuration c(shape, material, positions_m, tangent);
    c.check(direction_m, "direction_m");
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    c.elements->evaluate(c.team, positions_m.data()->data(), c.quaternion.data(), outputs);
    std::vector<Vec3> df(positions_m.size());
    c.elements->product(c.team, c.quaternion.data(), direction_m, c.corner, df);
    for (Vec3& v : df) v = -v;
    return df;
}

double von_mises(const Voigt& cauchy) { return fem::von_mises(cauchy); }

}  // namespace supple
