#include "supple/fem/elements.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "supple/base/assert.h"
#include "supple/fem/element_passes.h"
#include "supple/fem/hyper_parameters.h"
#include "supple/fem/nodal_volume.h"
#include "supple/fem/rest.h"
#include "supple/fem/tet4_hyper.h"

namespace supple::fem {

namespace {

/// Rows per chunk of an assembly.
constexpr std::size_t kRowChunk = 512;

template <class Assembly>
void fill_lists(Assembly& pass, const MatrixLists& lists, double scale, std::span<const double> shift) {
    pass.row_start = lists.row_start.data();
    pass.column = lists.column.data();
    pass.mirror = lists.mirror.data();
    pass.contribution_start = lists.contribution_start.data();
    pass.contribution = lists.contribution.data();
    pass.stiffness_scale = scale;
    pass.diagonal_shift = shift.data();
}

/// What elements keep of their lambda beside a NodalVolume, and what goes to the vertices.
Lame kept(const Lame& lame) { return {std::min(lame.lambda_pa, lame.mu_pa), lame.mu_pa}; }

std::vector<Lame> kept(const std::vector<Lame>& lame, Volumetric volumetric) {
    std::vector<Lame> result = lame;
    if (volumetric == Volumetric::nodal) std::transform(lame.begin(), lame.end(), result.begin(), [](const Lame& l) { return kept(l); });
    return result;
}

/// Linear elasticity in a frame: small displacements and the corotational methods.
class FrameTets final : public Elements {
public:
    FrameTets(const ElementsDef& def, const Material& material)
        : def_(def),
          moduli_(make_moduli(*def.rest, kept(def.lame, volumetric_of(material)))),
          set_{*def.rest, *def.corners, moduli_, tet4_kernels(def.isa), frame_of(material)},
          plasticity_(plasticity_of(material)) {
        const std::size_t lanes = def.rest->blocks() * kBlock;
        const bool exact = def.exact_rotation && (set_.frame == Frame::polar || set_.frame == Frame::svd);
        if (exact) twist_.resize(lanes * 6);
        if (plasticity_.flows()) flow_.resize(lanes * kFlowParameters);
        if (volumetric_of(material) == Volumetric::nodal) {
            std::vector<double> excess(lanes, 0.0);
            for (std::size_t e = 0; e < def.rest->elements; ++e) {
                const Lame& l = def.lame[def.lame.size() == 1 ? 0 : e];
                excess[e] = l.lambda_pa - kept(l).lambda_pa;
            }
            nodal_.emplace(*def.rest, excess);
            dilatation_.resize(lanes);
            pressure_.resize(lanes);
        }
        if (def.precision == MatrixPrecision::single) {
            record_f_.resize(lanes * kRecord);
            if (exact) twist_f_.resize(lanes * kTwistRecord);
        }
        if (def.precision == MatrixPrecision::double_) {
            record_d_.resize(lanes * kRecord);
            if (exact) twist_d_.resize(lanes * kTwistRecord);
        }
        if (def.precision == MatrixPrecision::none) return;
        laplacian_.assign(def.lists.blocks(), 0.0);
        for (std::size_t b = 0; b < laplacian_.size(); ++b) {
            for (std::int64_t i = def.lists.contribution_start[b]; i < def.lists.contribution_start[b + 1]; ++i) {
                laplacian_[b] += laplacian_entry(*def.rest, moduli_, def.lists.contribution[std::size_t(i)]);
            }
        }
    }

    void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) override {
        Tet4Pass pass;
        pass.position = position;
        pass.quaternion = quaternion;
        if (nodal_) {  // the pressures first: they need the dilatation of every element
            pass.dilatation = dilatation_.data();
            run_elements(team, set_, pass);
            nodal_->pressures(team, dilatation_.data(), pressure_.data());
            pass.dilatation = nullptr;
            pass.pressure = pressure_.data();
        }
        pass.corner_force = outputs.corner_force;
        pass.energy = outputs.energy;
        pass.stress = outputs.stress;
        pass.plastic = outputs.plastic;
        pass.project = def_.project;
        const auto give = [&](auto& array) { return outputs.tangent && !array.empty() ? array.data() : nullptr; };
        pass.record_f = give(record_f_);
        pass.record_d = give(record_d_);
        pass.twist = give(twist_);
        pass.twist_f = give(twist_f_);
        pass.twist_d = give(twist_d_);
        run_elements(team, set_, pass);
        if (nodal_ && outputs.energy != nullptr) nodal_->add_energy(outputs.energy);
    }

    std::optional<Lame> lame(std::size_t element) const override { return def_.lame[def_.lame.size() == 1 ? 0 : element]; }

    void product(Team& team, const double* quaternion, std::span<const Vec3> field, AlignedVector<double>& corner,
                 std::vector<Vec3>& out) override {
        Tet4Product pass;
        pass.quaternion = quaternion;
        pass.twist = twist_.empty() ? nullptr : twist_.data();
        pass.field = field.data()->data();
        if (nodal_) {
            pass.dilatation = dilatation_.data();
            run_product(team, set_, pass);
            nodal_->pressures(team, dilatation_.data(), pressure_.data());
            pass.dilatation = nullptr;
            pass.pressure = pressure_.data();
        }
        pass.corner_force = corner.data();
        run_product(team, set_, pass);
        gather(team, set_.corners, corner, out);
    }

    bool is_coupled() const override { return nodal_.has_value(); }
    void couple(Team& team, double scale, const float* x, float* y) override { nodal_->multiply_add(team, record_f_.data(), scale, x, y); }
    void couple(Team& team, double scale, const double* x, double* y) override { nodal_->multiply_add(team, record_d_.data(), scale, x, y); }
    void add_coupling_diagonal(Team& team, std::span<Mat3> diagonal) override {
        if (!record_f_.empty()) nodal_->add_diagonal(team, record_f_.data(), diagonal);
        if (!record_d_.empty()) nodal_->add_diagonal(team, record_d_.data(), diagonal);
    }

    bool is_plastic() const override { return plasticity_.flows(); }

    void flow(Team& team, const double* position, double* quaternion, double* plastic, double h) override {
        const double rate = -std::expm1(-plasticity_.creep_1_s * h);
        for (std::size_t i = 0; i < flow_.size(); ++i) {
            const std::size_t field = i / kBlock % kFlowParameters;
            flow_[i] = field == 0 ? plasticity_.yield : field == 1 ? plasticity_.max : rate;
        }
        const Tet4Flow pass{def_.rest->vertex.data(), def_.rest->gradient.data(), position, flow_.data(), quaternion, plastic};
        team.for_range(def_.rest->blocks(), kBlockChunk,
                       [&](std::size_t begin, std::size_t end) { set_.kernels.flow[std::size_t(set_.frame)](pass, begin, end); });
    }

    void assemble(Team& team, double scale, std::span<const double> shift, float* value) override {
        assemble_rows(team, scale, shift, record_f_, twist_f_, value, set_.kernels.assemble_f);
    }
    void assemble(Team& team, double scale, std::span<const double> shift, double* value) override {
        assemble_rows(team, scale, shift, record_d_, twist_d_, value, set_.kernels.assemble_d);
    }

private:
    template <class Real, class Kernel>
    void assemble_rows(Team& team, double scale, std::span<const double> shift, const AlignedVector<Real>& record,
                       const AlignedVector<Real>& twist, Real* value, Kernel kernel) {
        SUPPLE_ASSERT(!record.empty());
        Tet4Assembly<Real> pass;
        fill_lists(pass, def_.lists, scale, shift);
        pass.record = record.data();
        if (!twist.empty()) pass.twist = twist.data();
        pass.laplacian = laplacian_.data();
        pass.value = value;
        team.for_range(def_.lists.rows(), kRowChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    ElementsDef def_;
    AlignedVector<double> moduli_;
    ElementSet set_;
    Plasticity plasticity_;
    std::optional<NodalVolume> nodal_;
    AlignedVector<double> dilatation_, pressure_;
    std::vector<double> laplacian_;  ///< [matrix block] sum of mu V g_a.g_b
    AlignedVector<float> record_f_, twist_f_;
    AlignedVector<double> record_d_, twist_d_;
    AlignedVector<double> twist_;    ///< exact tangent only
    AlignedVector<double> flow_;     ///< parameters of plastic flow
};

/// Hyperelastic laws in principal stretches.
class HyperTets final : public Elements {
public:
    HyperTets(const ElementsDef& def, HyperParameters parameters)
        : def_(def), parameters_(std::move(parameters)), kernels_(tet4_hyper_kernels(def.isa)) {
        const std::size_t lanes = def.rest->blocks() * kBlock;
        tangent_.resize(lanes * kTangent);
        if (def.precision == MatrixPrecision::single) block_f_.resize(lanes * kElementBlocks);
        if (def.precision == MatrixPrecision::double_) block_d_.resize(lanes * kElementBlocks);
    }

    void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) override {
        Tet4HyperPass pass;
        pass.vertex = def_.rest->vertex.data();
        pass.gradient = def_.rest->gradient.data();
        pass.volume = def_.rest->volume.data();
        pass.parameter = parameters_.field.data();
        pass.parameters = parameters_.count;
        pass.position = position;
        pass.project = def_.project;
        pass.quaternion = quaternion;
        pass.corner_force = outputs.corner_force;
        pass.energy = outputs.energy;
        pass.stress = outputs.stress;
        if (outputs.tangent) {
            pass.tangent = tangent_.data();
            if (!block_f_.empty()) pass.block_f = block_f_.data();
            if (!block_d_.empty()) pass.block_d = block_d_.data();
        }
        const auto kernel = kernels_.elements[std::size_t(parameters_.law)];
        team.for_range(def_.rest->blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    std::optional<Lame> lame(std::size_t) const override { return {}; }

    void product(Team& team, const double*, std::span<const Vec3> field, AlignedVector<double>& corner, std::vector<Vec3>& out) override {
        const Tet4HyperProduct pass{def_.rest->vertex.data(), def_.rest->gradient.data(), def_.rest->volume.data(),
                                    tangent_.data(),          field.data()->data(),       corner.data()};
        team.for_range(def_.rest->blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernels_.product(pass, begin, end); });
        gather(team, *def_.corners, corner, out);
    }

    void assemble(Team& team, double scale, std::span<const double> shift, float* value) override {
        assemble_rows(team, scale, shift, block_f_, value, kernels_.assemble_f);
    }
    void assemble(Team& team, double scale, std::span<const double> shift, double* value) override {
        assemble_rows(team, scale, shift, block_d_, value, kernels_.assemble_d);
    }

private:
    template <class Real, class Kernel>
    void assemble_rows(Team& team, double scale, std::span<const double> shift, const AlignedVector<Real>& block, Real* value, Kernel kernel) {
        SUPPLE_ASSERT(!block.empty());
        BlockAssembly<Real> pass;
        fill_lists(pass, def_.lists, scale, shift);
        pass.block = block.data();
        pass.value = value;
        team.for_range(def_.lists.rows(), kRowChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    ElementsDef def_;
    HyperParameters parameters_;
    const Tet4HyperKernels& kernels_;
    AlignedVector<double> tangent_;
    AlignedVector<float> block_f_;
    AlignedVector<double> block_d_;
};

}  // namespace

std::unique_ptr<Elements> make_elements(const ElementsDef& def, const Material& material) {
    if (is_hyperelastic(material)) return std::make_unique<HyperTets>(def, make_hyper_parameters(*def.rest, material));
    return std::make_unique<FrameTets>(def, material);
}

}  // namespace supple::fem
