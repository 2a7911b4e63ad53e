#pragma once
// A few elements laid out for the kernels, and every output of a pass over them.
#include <span>
#include <vector>

#include "supple/fem/element_passes.h"
#include "supple/fem/rest.h"
#include "bodies.h"

namespace supple::test {

struct Elements {
    fem::Tet4Rest rest;
    AlignedVector<double> moduli, quaternion, corner, energy, stress, record_d;
    AlignedVector<float> record_f;

    Elements(std::span<const Vec3> vertices, std::span<const Tet> tets, const Lame& lame) : rest(fem::make_rest(vertices, tets)) {
        moduli = fem::make_moduli(rest.blocks(), std::span(&lame, 1));
        const std::size_t lanes = rest.blocks() * fem::kBlock;
        quaternion.resize(lanes * 4);
        corner.resize(lanes * 16);
        energy.resize(lanes);
        stress.resize(lanes * 6);
        record_d.resize(lanes * fem::kRecord);
        record_f.resize(lanes * fem::kRecord);
        for (std::size_t i = 0; i < lanes; ++i) set_quaternion(i, {1, 0, 0, 0});
    }

    void set_quaternion(std::size_t i, const std::array<double, 4>& wxyz) {
        for (std::size_t c = 0; c < 4; ++c) quaternion[(i / fem::kBlock * 4 + c) * fem::kBlock + i % fem::kBlock] = wxyz[c];
    }
    std::array<double, 4> wxyz(std::size_t i) const {
        std::array<double, 4> q;
        for (std::size_t c = 0; c < 4; ++c) q[c] = quaternion[(i / fem::kBlock * 4 + c) * fem::kBlock + i % fem::kBlock];
        return q;
    }
    Vec3 force(std::size_t i, std::size_t corner_index) const {
        const double* f = corner.data() + (i * 4 + corner_index) * 4;
        return {f[0], f[1], f[2]};
    }
    Mat3 cauchy(std::size_t i) const {
        const auto s = [&](std::size_t c) { return stress[(i / fem::kBlock * 6 + c) * fem::kBlock + i % fem::kBlock]; };
        Mat3 S;
        S << s(0), s(3), s(5), s(3), s(1), s(4), s(5), s(4), s(2);
        return S;
    }

    void run(Isa isa, std::span<const Vec3> positions, fem::Frame frame = fem::Frame::polar) {
        fem::Tet4Pass pass;
        pass.vertex = rest.vertex.data();
        pass.gradient = rest.gradient.data();
        pass.volume = rest.volume.data();
        pass.moduli = moduli.data();
        pass.position = positions.data()->data();
        pass.quaternion = quaternion.data();
        pass.corner_force = corner.data();
        pass.record_f = record_f.data();
        pass.record_d = record_d.data();
        pass.energy = energy.data();
        pass.stress = stress.data();
        fem::tet4_kernels(isa).elements[std::size_t(frame)](pass, 0, rest.blocks());
    }
};

inline std::vector<Isa> supported_isas() {
    std::vector<Isa> isas;
    for (const Isa isa : kAllIsas) {
        if (is_supported(isa)) isas.push_back(isa);
    }
    return isas;
}

}  // namespace supple::test
