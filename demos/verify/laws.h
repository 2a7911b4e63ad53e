#pragma once
// The laws in closed form, written a second time and in another way than the engine's: first Piola-Kirchhoff stress from tensors. A template, so that complex numbers give
// derivatives without cancellation (the complex step).
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "meshes.h"
#include "supple/material/material.h"

namespace supple::verify {

/// Every law with small-strain mu = 1000 Pa and a bulk modulus K.
struct NamedLaw {
    std::string name;
    Material material;
};
std::vector<NamedLaw> hyperelastic_laws(double bulk_pa = 1e4);
std::vector<NamedLaw> all_laws(double bulk_pa = 1e4);  ///< and linear, corotational

/// And Costa's law of the same moduli.
std::vector<NamedLaw> with_costa(std::vector<NamedLaw> laws);

/// True for the corotational material.
inline bool is_corotational(const Material& m) { return std::holds_alternative<Corotational>(m); }

template <class T>
using Tensor = Eigen::Matrix<T, 3, 3>;

namespace piola {

template <class T>
T trace_of_product(const Tensor<T>& A, const Tensor<T>& B) {
    return A.cwiseProduct(B.transpose()).sum();
}

template <class T>
Tensor<T> identity() {
    return Tensor<T>::Identity();
}

/// Isochoric parts of the stress: S = 2 w1 A1 + 2 w2 A2 + K lnJ C^-1.
template <class T>
Tensor<T> isochoric(const Tensor<T>& F, const std::function<T(T)>& w1, double w2, double K) {
    const Tensor<T> C = F.transpose() * F, Ci = C.inverse();
    const T J = F.determinant(), I1 = C.trace(), I2 = (I1 * I1 - trace_of_product(C, C)) / 2.0;
    const T j = std::pow(J, -2.0 / 3);
    const Tensor<T> A1 = j * (identity<T>() - I1 / 3.0 * Ci);
    const Tensor<T> A2 = j * j * (I1 * identity<T>() - C - 2.0 / 3 * I2 * Ci);
    return F * (2.0 * w1(j * I1) * A1 + 2.0 * w2 * A2 + K * std::log(J) * Ci);
}

template <class T>
Tensor<T> of(const Linear& m, const Tensor<T>& F) {
    const Lame l = lame_parameters(m.young_pa, m.poisson, "linear");
    const Tensor<T> e = 0.5 * (F + Tensor<T>(F.transpose())) - identity<T>();
    return 2.0 * l.mu_pa * e + l.lambda_pa * e.trace() * identity<T>();
}

template <class T>
Tensor<T> of(const Corotational& m, const Tensor<T>& F) {
    const Lame l = lame_parameters(m.young_pa, m.poisson, "corotational");
    Tensor<T> R = F;
    for (int i = 0; i < 12; ++i) R = 0.5 * (R + Tensor<T>(R.inverse().transpose()));  // Higham's iteration: analytic, so complex steps pass through
    return 2.0 * l.mu_pa * (F - R) + l.lambda_pa * ((R.transpose() * F).trace() - 3.0) * R;
}

template <class T>
Tensor<T> of(const StVenantKirchhoff& m, const Tensor<T>& F) {
    const Tensor<T> E = 0.5 * (Tensor<T>(F.transpose() * F) - identity<T>());
    return F * (m.lambda_pa * E.trace() * identity<T>() + 2.0 * m.mu_pa * E);
}

template <class T>
Tensor<T> of(const NeoHookean& m, const Tensor<T>& F) {
    const Tensor<T> Fit = F.inverse().transpose();
    return m.mu_pa * (F - Fit) + m.lambda_pa * std::log(F.determinant()) * Fit;
}

template <class T>
Tensor<T> of(const StableNeoHookean& m, const Tensor<T>& F) {
    const T J = F.determinant();
    const double sum = m.mu_pa + m.lambda_pa, alpha = 1 + m.mu_pa / sum;
    return m.mu_pa * F + sum * J * (J - alpha) * Tensor<T>(F.inverse().transpose());
}

template <class T>
Tensor<T> of(const MooneyRivlin& m, const Tensor<T>& F) {
    return isochoric<T>(F, [&](T) { return T(m.c1_pa); }, m.c2_pa, m.bulk_pa);
}

template <class T>
Tensor<T> of(const ArrudaBoyce& m, const Tensor<T>& F) {
    return isochoric<T>(
        F,
        [&](T I) {
            const double c[5] = {1.0 / 2, 1.0 / 20, 11.0 / 1050, 19.0 / 7000, 519.0 / 673750};
            T sum = 0, power = 1;
            for (int i = 1; i <= 5; ++i, power *= I / 8.0) sum += double(i) * c[i - 1] * power;
            return m.mu_pa * sum;
        },
        0, m.bulk_pa);
}

template <class T>
Tensor<T> of(const VerondaWestman& m, const Tensor<T>& F) {
    return isochoric<T>(F, [&](T I) { return m.c1_pa * m.c2 * std::exp(m.c2 * (I - 3.0)); }, -m.c1_pa * m.c2 / 2, m.bulk_pa);
}

/// Terms of exponent 2 and 4 only: their powers of C are whole numbers.
template <class T>
Tensor<T> of(const Ogden& m, const Tensor<T>& F) {
    const Tensor<T> C = F.transpose() * F, Ci = C.inverse();
    const T J = F.determinant();
    Tensor<T> S = m.bulk_pa * std::log(J) * Ci;
    for (const OgdenTerm& term : m.terms) {
        if (term.alpha != 2 && term.alpha != 4) throw std::invalid_argument("Ogden's closed form here: exponents 2 and 4");
        const Tensor<T> power = term.alpha == 2 ? identity<T>() : C;  // C^(alpha/2 - 1)
        const T trace = trace_of_product(power, C);
        S += term.mu_pa / term.alpha * std::pow(J, -term.alpha / 3) * (power - trace / 3.0 * Ci);
    }
    return F * S;
}

/// In the frame x y z.
template <class T>
Tensor<T> of(const Costa& m, const Tensor<T>& F) {
    const Tensor<T> C = F.transpose() * F, Ci = C.inverse();
    const Tensor<T> E = 0.5 * (C - identity<T>());
    Mat3 b;
    b << m.b[0], m.b[1], m.b[3], m.b[1], m.b[2], m.b[4], m.b[3], m.b[4], m.b[5];
    const Tensor<T> BE = b.template cast<T>().cwiseProduct(E);
    const T J = F.determinant(), j = std::pow(J, -4.0 / 3), Q = BE.cwiseProduct(E).sum();
    return F * (m.a_pa * std::exp(j * Q) * j * (BE - 2.0 / 3 * Q * Ci) + m.bulk_pa * J * std::log(J) * Ci);
}

}  // namespace piola

/// P(F) of a law.
template <class T>
Tensor<T> first_piola(const Material& material, const Tensor<T>& F) {
    return std::visit([&](const auto& m) { return piola::of<T>(m, F); }, material);
}

}  // namespace supple::verify
