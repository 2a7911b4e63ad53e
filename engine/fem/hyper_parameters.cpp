#include "supple/fem/hyper_parameters.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "supple/base/assert.h"

namespace supple::fem {

namespace {

/// The numbers of a law; those in pascals grow with the stiffness factor of an element.
struct Listed {
    Law law = Law::neo_hookean;
    std::vector<double> values;
    std::vector<bool> pascal;

    void add(double value, bool in_pascal) {
        values.push_back(value);
        pascal.push_back(in_pascal);
    }
};

Listed moduli(Law law, std::initializer_list<double> values) {
    Listed listed{law, {}, {}};
    for (const double value : values) listed.add(value, true);
    return listed;
}

Listed list(const StVenantKirchhoff& m) { return moduli(Law::st_venant_kirchhoff, {m.mu_pa, m.lambda_pa}); }
Listed list(const NeoHookean& m) { return moduli(Law::neo_hookean, {m.mu_pa, m.lambda_pa}); }
Listed list(const StableNeoHookean& m) { return moduli(Law::stable_neo_hookean, {m.mu_pa, m.lambda_pa}); }
Listed list(const MooneyRivlin& m) { return moduli(Law::mooney_rivlin, {m.c1_pa, m.c2_pa, m.bulk_pa}); }
Listed list(const ArrudaBoyce& m) { return moduli(Law::arruda_boyce, {m.mu_pa, m.bulk_pa}); }
Listed list(const VerondaWestman& m) { return {Law::veronda_westman, {m.c1_pa, m.c2, m.bulk_pa}, {true, false, true}}; }
Listed list(const Ogden& m) {
    Listed listed = moduli(Law::ogden, {m.bulk_pa});
    for (const OgdenTerm& term : m.terms) {
        listed.add(term.mu_pa, true);
        listed.add(term.alpha, false);
    }
    return listed;
}
Listed list(const Costa& m) {
    Listed listed = moduli(Law::costa, {m.a_pa, m.bulk_pa});
    for (const double b : m.b) listed.add(b, false);
    return listed;
}
Listed list(const Linear&) { return {}; }
Listed list(const Corotational&) { return {}; }

struct Entry {
    Listed listed;
    double inversion = 0;
    const Fibres* fibres = nullptr;
};

Entry entry_of(const Material& material) {
    // A turned-out element is pushed back about as hard as a thoroughly squeezed one: ten times the small-strain stiffness of uniaxial strain.
    const Lame small = small_strain(material);
    return {std::visit([](const auto& m) { return list(m); }, material), 10 * (std::max(small.lambda_pa, 0.0) + 2 * small.mu_pa), fibres_of(material)};
}

const Vec3& direction(const std::vector<Vec3>& directions, std::size_t element) { return directions[directions.size() == 1 ? 0 : element]; }

void write_family(double* to, double stiffness, double exponent, const std::vector<Vec3>& directions, std::size_t element) {
    const bool some = stiffness > 0;
    const Vec3 f = some ? direction(directions, element).normalized() : Vec3::Zero();
    const double values[kFibre] = {some ? stiffness : 0, some ? exponent : 1, f[0], f[1], f[2]};
    for (std::size_t i = 0; i < kFibre; ++i) to[i * kBlock] = values[i];
}

}  // namespace

Mat3 material_frame(const Fibres& fibres, std::size_t element) {
    const Vec3 f = fibres.fibre.empty() ? Vec3(Vec3::UnitX()) : direction(fibres.fibre, element).normalized();
    const Vec3 axis = f.cross(Vec3::UnitY()).norm() > 1e-6 ? Vec3::UnitY() : Vec3::UnitZ();
    const Vec3 sheet = fibres.sheet.empty() ? axis : direction(fibres.sheet, element).normalized();
    const Vec3 s = (sheet - f.dot(sheet) * f).normalized();
    Mat3 Q0;
    Q0 << f, s, f.cross(s);
    return Q0;
}

HyperParameters make_hyper_parameters(const ElementGroup& group, const ElementMaterials& materials) {
    std::vector<Entry> entries(materials.materials.size());  // of the materials in this group
    bool any_fibre = false, any_sheet = false;
    for (const std::int32_t e : group.element) {
        Entry& entry = entries[materials.index(std::size_t(e))];
        if (entry.fibres != nullptr) continue;
        entry = entry_of(materials.of(std::size_t(e)));
        SUPPLE_ASSERT(entry.fibres != nullptr);
        any_fibre |= entry.fibres->fibre_stiffness_pa > 0;
        any_sheet |= entry.fibres->sheet_stiffness_pa > 0;
    }
    const Listed& first = entries[materials.index(std::size_t(group.element[0]))].listed;
    const std::size_t count = first.values.size();

    HyperParameters p;
    p.law = first.law;
    p.count = 1 + count + (is_tensor_law(p.law) ? 9 : 0);
    p.families = std::size_t(any_fibre) + std::size_t(any_sheet);
    p.field.resize(group.blocks() * p.count * kBlock);
    p.fibre.resize(group.blocks() * p.families * kFibre * kBlock);
    for (std::size_t i = 0; i < group.blocks() * kBlock; ++i) {
        const std::size_t element = std::size_t(group.element[std::min(i, group.element.size() - 1)]);
        const Entry& entry = entries[materials.index(element)];
        SUPPLE_ASSERT(entry.listed.law == p.law && entry.listed.values.size() == count);
        const double factor = materials.factor(element);
        double* to = p.field.data() + i / kBlock * p.count * kBlock + i % kBlock;
        to[0] = factor * entry.inversion;
        for (std::size_t k = 0; k < count; ++k) to[(k + 1) * kBlock] = entry.listed.values[k] * (entry.listed.pascal[k] ? factor : 1);
        if (is_tensor_law(p.law)) {
            const Mat3 Q0 = material_frame(*entry.fibres, element);
            for (Eigen::Index k = 0; k < 9; ++k) to[(1 + count + std::size_t(k)) * kBlock] = Q0(k / 3, k % 3);
        }
        double* fibre = p.fibre.data() + i / kBlock * p.families * kFibre * kBlock + i % kBlock;
        if (any_fibre) {
            write_family(fibre, factor * entry.fibres->fibre_stiffness_pa, entry.fibres->fibre_exponent, entry.fibres->fibre, element);
            fibre += kFibre * kBlock;
        }
        if (any_sheet) write_family(fibre, factor * entry.fibres->sheet_stiffness_pa, entry.fibres->sheet_exponent, entry.fibres->sheet, element);
    }
    return p;
}

}  // namespace supple::fem
