#include "supple/world/evaluate.h"

#include "supple/base/error.h"
#include "supple/fem/element_passes.h"
#include "supple/fem/elements.h"
#include "supple/fem/stress.h"
#include "supple/world/stress_field.h"

namespace supple {

namespace {

/// One configuration of a shape: elements, rotations, scratch. The scalar kernels: an evaluation is a reference, not a race.
struct Configuration {
    Configuration(const BodyTemplate& shape, const Material& material, std::span<const Vec3> positions, Tangent tangent = Tangent::automatic)
        : layout(shape.data().layout) {
        check(positions, "positions_m");
        fem::ElementsDef def;
        check_material(material, layout.elements);  // throws with the name of what is out of range
        def.layout = &layout;
        def.project = false;
        def.exact_rotation = tangent == Tangent::exact;
        elements = fem::make_elements(def, {.materials = {material}, .material_of_element = {}, .stiffness_factor = {}});
        quaternion.resize(layout.blocks * 4 * fem::kBlock);
        force_parts.resize(layout.places * 4);
        fem::seed_rotations(team, layout, positions, quaternion);
    }

    void check(std::span<const Vec3> field, const char* what) const {
        if (field.size() != layout.vertices) {
            throw Error(ErrorCode::invalid_argument, what,
                        std::to_string(field.size()) + " vectors for a mesh of " + std::to_string(layout.vertices) + " vertices");
        }
        for (std::size_t i = 0; i < field.size(); ++i) {
            if (!field[i].allFinite()) throw Error(ErrorCode::invalid_argument, what, "vector " + std::to_string(i) + " is not finite");
        }
    }

    const fem::ElementLayout& layout;
    Team team;
    std::unique_ptr<fem::Elements> elements;
    AlignedVector<double> quaternion, force_parts;
};

}  // namespace

Evaluation evaluate(const BodyTemplate& shape, const Material& material, std::span<const Vec3> positions_m) {
    Configuration c(shape, material, positions_m);
    const std::size_t elements = c.layout.elements;
    AlignedVector<double> energy(c.layout.blocks * fem::kBlock), stress(c.layout.blocks * 6 * fem::kBlock);
    fem::ElementOutputs outputs;
    outputs.force = c.force_parts.data();
    outputs.energy = energy.data();
    outputs.stress = stress.data();
    c.elements->evaluate(c.team, positions_m.data()->data(), c.quaternion.data(), outputs);

    Evaluation result;
    result.forces_n.resize(positions_m.size());
    fem::gather(c.team, c.layout.forces, c.force_parts, result.forces_n);
    for (const double w : energy) result.energy_j += w;
    result.element_stress_pa.resize(elements);
    for (std::size_t e = 0; e < elements; ++e) result.element_stress_pa[e] = fem::element_stress(c.layout, stress.data(), e);
    result.vertex_stress_pa.resize(positions_m.size());
    for (std::size_t v = 0; v < positions_m.size(); ++v) {
        result.vertex_stress_pa[v] = fem::recover_at_vertex(c.layout.around, c.layout.volume, result.element_stress_pa, v);
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
    fem::stiffness_product(c.team, *c.elements, c.layout, c.quaternion.data(), direction_m, c.force_parts, df);
    for (Vec3& v : df) v = -v;
    return df;
}

StressField evaluate_stress(const BodyTemplate& shape, const Material& material, std::span<const Vec3> positions_m, const StressDef& def) {
    Configuration c(shape, material, positions_m);
    AlignedVector<double> stress(c.layout.blocks * 6 * fem::kBlock);
    fem::ElementOutputs outputs;
    outputs.stress = stress.data();
    c.elements->evaluate(c.team, positions_m.data()->data(), c.quaternion.data(), outputs);
    std::vector<Voigt> own(c.layout.elements);
    for (std::size_t e = 0; e < own.size(); ++e) own[e] = fem::element_stress(c.layout, stress.data(), e);
    StressField field;
    std::vector<Voigt> scratch;
    fill_stress(shape.data(), *c.elements, positions_m, own, def, c.team, scratch, field);
    return field;
}

}  // namespace supple
