#include "supple/fem/elements.h"

#include <algorithm>
#include <cmath>

#include "supple/base/assert.h"
#include "supple/fem/element_groups.h"
#include "supple/fem/element_passes.h"

namespace supple::fem {

namespace {

/// Several groups as one: each works on its own stretch of the body's arrays.
class GroupedElements final : public Elements {
public:
    GroupedElements(const ElementLayout& layout, std::vector<std::unique_ptr<Elements>> groups) : layout_(layout), groups_(std::move(groups)) {}

    void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) override {
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            const std::size_t first = layout_.groups[g].first_block * kBlock;
            ElementOutputs part = outputs;
            if (part.force != nullptr) part.force += layout_.groups[g].first_place * 4;
            if (part.energy != nullptr) part.energy += first;
            if (part.stress != nullptr) part.stress += first * 6;
            if (part.plastic != nullptr) part.plastic += first * 6;
            groups_[g]->evaluate(team, position, quaternion + first * 4, part);
        }
    }

    std::optional<Lame> lame(std::size_t element) const override {
        const std::size_t slot = layout_.slot[element];
        std::size_t g = groups_.size() - 1;
        while (layout_.groups[g].first_block > slot / kBlock) --g;
        return groups_[g]->lame(slot - layout_.groups[g].first_block * kBlock);
    }

    void product(Team& team, const double* quaternion, const double* field, double* value) override {
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            groups_[g]->product(team, quaternion + layout_.groups[g].first_block * kBlock * 4, field, value + layout_.groups[g].first_place * 4);
        }
    }

    void assemble(Team& team, double scale, std::span<const double> shift, float* value) override { assemble_all(team, scale, shift, value); }
    void assemble(Team& team, double scale, std::span<const double> shift, double* value) override { assemble_all(team, scale, shift, value); }

    bool is_coupled() const override { return std::any_of(groups_.begin(), groups_.end(), [](const auto& group) { return group->is_coupled(); }); }
    void couple(Team& team, double scale, const float* x, float* y) override { couple_all(team, scale, x, y); }
    void couple(Team& team, double scale, const double* x, double* y) override { couple_all(team, scale, x, y); }
    void add_coupling_diagonal(Team& team, std::span<Mat3> diagonal) override {
        for (auto& group : groups_) {
            if (group->is_coupled()) group->add_coupling_diagonal(team, diagonal);
        }
    }

    bool is_plastic() const override { return std::any_of(groups_.begin(), groups_.end(), [](const auto& group) { return group->is_plastic(); }); }
    void flow(Team& team, const double* position, double* quaternion, double* plastic, double h) override {
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            const std::size_t first = layout_.groups[g].first_block * kBlock;
            groups_[g]->flow(team, position, quaternion + first * 4, plastic + first * 6, h);
        }
    }

private:
    template <class Real>
    void couple_all(Team& team, double scale, const Real* x, Real* y) {
        for (auto& group : groups_) {
            if (group->is_coupled()) group->couple(team, scale, x, y);
        }
    }

    template <class Real>
    void assemble_all(Team& team, double scale, std::span<const double> shift, Real* value) {
        for (std::size_t g = 0; g < groups_.size(); ++g) groups_[g]->assemble(team, scale, g == 0 ? shift : std::span<const double>(), value);
    }

    const ElementLayout& layout_;
    std::vector<std::unique_ptr<Elements>> groups_;
};

std::unique_ptr<Elements> make_group(const GroupDef& def, const ElementMaterials& materials) {
    const bool hyperelastic = is_hyperelastic(materials.of(std::size_t(def.group->element[0])));
    if (def.group->kind == ElementKind::tet) return hyperelastic ? make_hyper_tets(def, materials) : make_frame_tets(def, materials);
    return hyperelastic ? make_hyper_hexes(def, materials) : make_frame_hexes(def, materials);
}

/// Materials of one family differ in numbers only: the same law, way to the rotation, regularization and number of terms.
std::int32_t family_of(const Material& material) {
    std::size_t variant = 0;
    if (const auto* corotational = std::get_if<Corotational>(&material)) variant = std::size_t(corotational->rotation);
    if (volumetric_of(material) == Volumetric::nodal) variant += kFrames;
    if (const auto* ogden = std::get_if<Ogden>(&material)) variant = ogden->terms.size();
    variant = 2 * variant + (is_regularized(material) ? 1 : 0);
    return std::int32_t(material.index() + std::variant_size_v<Material> * variant);
}

}  // namespace

std::vector<std::int32_t> ElementMaterials::families(std::size_t elements) const {
    std::vector<std::int32_t> of_material;
    for (const Material& material : materials) of_material.push_back(family_of(material));
    std::vector<std::int32_t> family(elements, of_material[0]);
    for (std::size_t e = 0; e < material_of_element.size(); ++e) family[e] = of_material[std::size_t(material_of_element[e])];
    return family;
}

Lame ElementMaterials::lame_of(std::size_t element) const {
    const Lame lame = small_strain(of(element));
    return {factor(element) * lame.lambda_pa, factor(element) * lame.mu_pa};
}

std::vector<Lame> group_lame(const ElementGroup& group, const ElementMaterials& materials) {
    std::vector<Lame> of_material, lame;  // of each material once: bodies under the knife are made again and again
    for (const Material& material : materials.materials) of_material.push_back(small_strain(material));
    lame.reserve(group.element.size());
    for (const std::int32_t e : group.element) {
        const Lame& l = of_material[materials.index(std::size_t(e))];
        const double factor = materials.factor(std::size_t(e));
        lame.push_back({factor * l.lambda_pa, factor * l.mu_pa});
    }
    return lame;
}

PlasticFlow::PlasticFlow(std::vector<Plasticity> of_element) : of_element_(std::move(of_element)) {
    if (std::any_of(of_element_.begin(), of_element_.end(), [](const Plasticity& p) { return p.flows(); })) {
        parameter_.resize((of_element_.size() + kBlock - 1) / kBlock * kBlock * kFlowParameters);
    }
}

const double* PlasticFlow::parameters(double h) {
    if (h == h_) return parameter_.data();
    h_ = h;
    for (std::size_t i = 0; i < parameter_.size(); ++i) {
        const std::size_t block = i / (kFlowParameters * kBlock), field = i / kBlock % kFlowParameters;
        const Plasticity& p = of_element_[std::min(block * kBlock + i % kBlock, of_element_.size() - 1)];
        parameter_[i] = field == 0 ? p.yield : field == 1 ? p.max : -std::expm1(-p.creep_1_s * h);
    }
    return parameter_.data();
}

PlasticFlow group_plasticity(const ElementGroup& group, const ElementMaterials& materials) {
    if (std::none_of(materials.materials.begin(), materials.materials.end(), [](const Material& m) { return plasticity_of(m).flows(); })) return PlasticFlow({});
    std::vector<Plasticity> plasticity;
    for (const std::int32_t e : group.element) plasticity.push_back(plasticity_of(materials.of(std::size_t(e))));
    return PlasticFlow(std::move(plasticity));
}

std::unique_ptr<Elements> make_elements(const ElementsDef& def, const ElementMaterials& materials) {
    std::vector<std::unique_ptr<Elements>> groups;
    for (std::size_t g = 0; g < def.layout->groups.size(); ++g) {
        GroupDef group;
        group.group = &def.layout->groups[g];
        group.pattern = def.pattern;
        if (def.precision != MatrixPrecision::none) group.contributions = def.contributions[g];
        group.precision = def.precision;
        group.isa = def.isa;
        group.project = def.project;
        group.exact_rotation = def.exact_rotation;
        groups.push_back(make_group(group, materials));
    }
    SUPPLE_ASSERT(!groups.empty());
    if (groups.size() == 1) return std::move(groups[0]);
    return std::make_unique<GroupedElements>(*def.layout, std::move(groups));
}

void stiffness_product(Team& team, Elements& elements, const ElementLayout& layout, const double* quaternion, std::span<const Vec3> field,
                       AlignedVector<double>& corner, std::vector<Vec3>& out) {
    elements.product(team, quaternion, field.data()->data(), corner.data());
    gather(team, layout.forces, corner, out);
}

}  // namespace supple::fem
