#include "supple/material/material.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "supple/base/error.h"

namespace supple {

namespace {

/// Throws unless the value is finite and above the bound.
void require_above(double value, double bound, const std::string& where, const char* fix) {
    if (std::isfinite(value) && value > bound) return;
    throw Error(ErrorCode::invalid_argument, where, to_text(value) + " must be finite and above " + to_text(bound) + "; " + fix);
}

Lame check_lame(double mu, double lambda, const std::string& where) {
    require_above(mu, 0, where + ".mu_pa", "it is the shear modulus in pascals, E/(2 (1 + nu))");
    require_above(lambda, -2 * mu / 3, where + ".lambda_pa", "below it the bulk modulus lambda + 2 mu/3 is not positive; E nu/((1 + nu)(1 - 2 nu))");
    return {lambda, mu};
}

/// From a shear and a bulk modulus.
Lame from_bulk(double mu, double bulk, const std::string& where) {
    require_above(bulk, 0, where + ".bulk_pa", "it is the bulk modulus in pascals; soft tissue has 10 to 1000 times its shear modulus");
    return {bulk - 2 * mu / 3, mu};
}

void check(const Plasticity& p, const std::string& where) {
    const auto not_negative = [&](double value, const char* name, const char* fix) {
        if (!(value >= 0)) throw Error(ErrorCode::invalid_argument, where + "." + name, to_text(value) + " must not be negative; " + fix);
    };
    not_negative(p.yield, "plastic_yield", "it is a strain: 0.01 to 0.2 is usual");
    not_negative(p.max, "plastic_max", "it is a strain; leave it out for no limit");
    not_negative(p.creep_1_s, "plastic_creep_1_s", "it is a rate; leave it out for flow at once");
}

Lame small(const Corotational& m, const std::string& where) {
    check(m.plasticity, where);
    return lame_parameters(m.young_pa, m.poisson, where);
}
Lame small(const Linear& m, const std::string& where) {
    check(m.plasticity, where);
    return lame_parameters(m.young_pa, m.poisson, where);
}
Lame small(const StVenantKirchhoff& m, const std::string& where) { return check_lame(m.mu_pa, m.lambda_pa, where); }
Lame small(const NeoHookean& m, const std::string& where) { return check_lame(m.mu_pa, m.lambda_pa, where); }
Lame small(const StableNeoHookean& m, const std::string& where) { return check_lame(m.mu_pa, m.lambda_pa, where); }

Lame small(const MooneyRivlin& m, const std::string& where) {
    require_above(m.c1_pa + m.c2_pa, 0, where + ".c1_pa", "the sum c1_pa + c2_pa is half the shear modulus");
    return from_bulk(2 * (m.c1_pa + m.c2_pa), m.bulk_pa, where);
}

Lame small(const ArrudaBoyce& m, const std::string& where) {
    require_above(m.mu_pa, 0, where + ".mu_pa", "the shear modulus is 1.0851367 times it");
    return from_bulk(1.0851367078791743 * m.mu_pa, m.bulk_pa, where);
}

Lame small(const VerondaWestman& m, const std::string& where) {
    require_above(m.c1_pa, 0, where + ".c1_pa", "the shear modulus is c1_pa c2");
    require_above(m.c2, 0, where + ".c2", "the shear modulus is c1_pa c2");
    return from_bulk(m.c1_pa * m.c2, m.bulk_pa, where);
}

Lame small(const Ogden& m, const std::string& where) {
    if (m.terms.empty()) throw Error(ErrorCode::invalid_argument, where + ".terms", "is empty; give at least one {mu_pa, alpha}");
    double sum = 0;
    for (std::size_t i = 0; i < m.terms.size(); ++i) {
        if (!std::isfinite(m.terms[i].alpha) || m.terms[i].alpha == 0) {
            throw Error(ErrorCode::invalid_argument, where + ".terms[" + std::to_string(i) + "].alpha", to_text(m.terms[i].alpha) + " must be finite and not 0");
        }
        sum += m.terms[i].mu_pa;
    }
    require_above(sum, 0, where + ".terms", "the sum of the terms' mu_pa is twice the shear modulus");
    return from_bulk(sum / 2, m.bulk_pa, where);
}

/// Voigt's averages: K = bulk + a sum(b_ii)/9, mu = (sum C_ii - sum C_ij + 3 sum G_ij)/15.
Lame small(const Costa& m, const std::string& where) {
    require_above(m.a_pa, 0, where + ".a_pa", "it scales the exponential; the shear moduli are a_pa b/2");
    require_above(m.bulk_pa, 0, where + ".bulk_pa", "it acts as Lame's lambda; soft tissue has 10 to 1000 times its shear modulus");
    for (std::size_t i = 0; i < 6; ++i) require_above(m.b[i], 0, where + ".b[" + std::to_string(i) + "]", "the order is ff fs ss fn sn nn; tissue has 1 to 50");
    const double axes = m.b[0] + m.b[2] + m.b[5], shears = m.b[1] + m.b[3] + m.b[4];
    return from_bulk(m.a_pa * (axes + 1.5 * shears) / 15, m.bulk_pa + m.a_pa * axes / 9, where);
}

void check_family(const std::vector<Vec3>& directions, double stiffness, double exponent, bool directions_have_another_use, std::size_t elements,
                  const std::string& where, const std::string& name) {
    const auto fail = [&](const std::string& key, const std::string& message) { throw Error(ErrorCode::invalid_argument, where + "." + key, message); };
    if (!(std::isfinite(stiffness) && stiffness >= 0)) fail(name + "_stiffness_pa", to_text(stiffness) + " must be finite and not below 0; 0 means no such fibres");
    if (stiffness > 0 && directions.empty()) fail(name + "_stiffness_pa", "is " + to_text(stiffness) + " Pa but there is no \"" + name + "\" direction; give one, or one per element");
    if (stiffness == 0 && !directions.empty() && !directions_have_another_use) {
        fail(name, "has directions but " + name + "_stiffness_pa is 0, so they change nothing; give the stiffness or remove them");
    }
    if (stiffness > 0) require_above(exponent, 0, where + "." + name + "_exponent", "1 to 50 is usual");
    if (directions.size() > 1 && directions.size() != elements) {
        fail(name, "has " + std::to_string(directions.size()) + " directions, the body has " + std::to_string(elements) + " elements; give one for all, or one each");
    }
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const double length = directions[i].norm();
        if (!(std::isfinite(length) && length > 1e-100)) {
            fail(directions.size() == 1 ? name : name + "[" + std::to_string(i) + "]", "is not a direction; give three finite numbers that are not all 0");
        }
    }
}

/// Costa's frame needs a sheet direction that is not along the fibre.
void check_frame(const Fibres& m, const std::string& where) {
    if (m.fibre.empty() && !m.sheet.empty()) throw Error(ErrorCode::invalid_argument, where + ".sheet", "is given without a fibre direction; give both, or only the fibre");
    for (std::size_t i = 0; i < std::max(m.fibre.size(), m.sheet.size()); ++i) {
        if (m.fibre.empty() || m.sheet.empty()) break;
        const Vec3& f = m.fibre[m.fibre.size() == 1 ? 0 : i];
        const Vec3& s = m.sheet[m.sheet.size() == 1 ? 0 : i];
        if (f.cross(s).norm() > 1e-6 * f.norm() * s.norm()) continue;
        throw Error(ErrorCode::invalid_argument, where + ".sheet", "lies along the fibre (direction " + std::to_string(i) + "); the frame [f s n] needs two directions");
    }
}

}  // namespace

const Fibres* fibres_of(const Material& material) {
    return std::visit(
        [](const auto& m) -> const Fibres* {
            if constexpr (requires { m.fibres; }) return &m.fibres;
            return nullptr;
        },
        material);
}

bool is_regularized(const Material& material) {
    return std::visit(
        [](const auto& m) {
            if constexpr (requires { m.matrix_regularization; }) return m.matrix_regularization;
            return true;
        },
        material);
}

void check_material(const Material& material, std::size_t elements, const std::string& where) {
    small_strain(material, where);
    const Fibres* f = fibres_of(material);
    if (f == nullptr) return;
    const bool frame = std::holds_alternative<Costa>(material);
    check_family(f->fibre, f->fibre_stiffness_pa, f->fibre_exponent, frame, elements, where, "fibre");
    check_family(f->sheet, f->sheet_stiffness_pa, f->sheet_exponent, frame, elements, where, "sheet");
    if (frame) check_frame(*f, where);
}

bool is_hyperelastic(const Material& material) { return !std::holds_alternative<Corotational>(material) && !std::holds_alternative<Linear>(material); }

Plasticity plasticity_of(const Material& material) {
    if (const auto* corotational = std::get_if<Corotational>(&material)) return corotational->plasticity;
    if (const auto* linear = std::get_if<Linear>(&material)) return linear->plasticity;
    return {};
}

Volumetric volumetric_of(const Material& material) {
    if (const auto* corotational = std::get_if<Corotational>(&material)) return corotational->volumetric;
    if (const auto* linear = std::get_if<Linear>(&material)) return linear->volumetric;
    return Volumetric::element;
}

Lame small_strain(const Material& material, const std::string& where) {
    return std::visit([&](const auto& law) { return small(law, where); }, material);
}

Lame lame_parameters(double young_pa, double poisson, const std::string& where) {
    if (!(std::isfinite(young_pa) && young_pa > 0)) {
        throw Error(ErrorCode::invalid_argument, where + ".young_pa",
                    to_text(young_pa) + " is not a Young's modulus; give a finite number of pascals above 0 (soft tissue 1e3 to 1e5, rubber 1e6)");
    }
    if (!(poisson > -1 && poisson < 0.5)) {
        throw Error(ErrorCode::invalid_argument, where + ".poisson",
                    to_text(poisson) + " is outside (-1, 0.5); nearly incompressible matter has 0.45 to 0.499");
    }
    return {young_pa * poisson / ((1 + poisson) * (1 - 2 * poisson)), young_pa / (2 * (1 + poisson))};
}

}  // namespace supple
