#include "supple/fem/elements.h"

#include <algorithm>
#include <cmath>

#include "supple/base/assert.h"
#include "supple/base/error.h"
#include "supple/fem/element_passes.h"
#include "supple/fem/hyper_parameters.h"
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

/// Linear elasticity in a frame: small displacements and the corotational methods.
class FrameTets final : public Elements {
public:
    FrameTets(const ElementsDef& def, const ElementMaterials& materials)
        : def_(def),
          moduli_(make_moduli(*def.rest, element_lame(materials, def.rest->elements))),
          set_{*def.rest, *def.corners, moduli_, tet4_kernels(def.isa), frame_of(materials.list[0])} {
        const std::size_t lanes = def.rest->blocks() * kBlock;
        const bool exact = def.exact_rotation && (set_.frame == Frame::polar || set_.frame == Frame::svd);
        if (exact) twist_.resize(lanes * 6);
        fill_flow(materials);
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
    }

    void product(Team& team, const double* quaternion, std::span<const Vec3> field, AlignedVector<double>& corner,
                 std::vector<Vec3>& out) override {
        stiffness_product(team, set_, quaternion, twist_.empty() ? nullptr : twist_.data(), field, corner, out);
    }

    bool is_plastic() const override { return !flow_.empty(); }

    void flow(Team& team, const double* position, double* quaternion, double* plastic, double h) override {
        for (std::size_t i = 0; h != flow_h_ && i < creep_1_s_.size(); ++i) {
            flow_[(i / kBlock * kFlowParameters + 2) * kBlock + i % kBlock] = -std::expm1(-creep_1_s_[i] * h);
        }
        flow_h_ = h;
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
    /// Parameters of plastic flow of each element; none where no material flows.
    void fill_flow(const ElementMaterials& materials) {
        if (std::none_of(materials.list.begin(), materials.list.end(), [](const Material& m) { return plasticity_of(m).flows(); })) return;
        const std::size_t lanes = def_.rest->blocks() * kBlock;
        flow_.resize(lanes * kFlowParameters);
        creep_1_s_.resize(lanes);
        for (std::size_t i = 0; i < lanes; ++i) {
            const Plasticity plasticity = plasticity_of(materials.at(std::min(i, def_.rest->elements - 1)));
            double* to = flow_.data() + i / kBlock * kFlowParameters * kBlock + i % kBlock;
            to[0] = plasticity.yield;
            to[kBlock] = plasticity.max;
            creep_1_s_[i] = plasticity.creep_1_s;
        }
    }

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
    std::vector<double> laplacian_;  ///< [matrix block] sum of mu V g_a.g_b
    AlignedVector<float> record_f_, twist_f_;
    AlignedVector<double> record_d_, twist_d_;
    AlignedVector<double> twist_;    ///< exact tangent only
    AlignedVector<double> flow_;     ///< [block][yield max rate][lane] of plastic flow; the rate for steps of flow_h_
    std::vector<double> creep_1_s_;
    double flow_h_ = -1;
};

/// Hyperelastic laws.
class HyperTets final : public Elements {
public:
    HyperTets(const ElementsDef& def, const ElementMaterials& materials)
        : def_(def), parameters_(make_hyper_parameters(*def.rest, materials)), kernels_(tet4_hyper_kernels(def.isa)) {
        const std::size_t lanes = def.rest->blocks() * kBlock;
        def_.project = def.project && is_regularized(materials.list[0]);
        tangent_.resize(lanes * (is_tensor_law(parameters_.law) ? kTensorTangent : kTangent));
        fibre_tangent_.resize(lanes * parameters_.families * kFibreTangent);
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
        pass.fibre = parameters_.fibre.data();
        pass.families = parameters_.families;
        pass.position = position;
        pass.project = def_.project;
        pass.quaternion = quaternion;
        pass.corner_force = outputs.corner_force;
        pass.energy = outputs.energy;
        pass.stress = outputs.stress;
        if (outputs.tangent) {
            pass.tangent = tangent_.data();
            pass.fibre_tangent = fibre_tangent_.data();
            if (!block_f_.empty()) pass.block_f = block_f_.data();
            if (!block_d_.empty()) pass.block_d = block_d_.data();
        }
        const auto kernel = kernels_.elements[std::size_t(parameters_.law)];
        team.for_range(def_.rest->blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    void product(Team& team, const double*, std::span<const Vec3> field, AlignedVector<double>& corner, std::vector<Vec3>& out) override {
        Tet4HyperProduct pass;
        pass.vertex = def_.rest->vertex.data();
        pass.gradient = def_.rest->gradient.data();
        pass.volume = def_.rest->volume.data();
        pass.tangent = tangent_.data();
        pass.parameter = parameters_.field.data();
        pass.parameters = parameters_.count;
        pass.fibre = parameters_.fibre.data();
        pass.fibre_tangent = fibre_tangent_.data();
        pass.families = parameters_.families;
        pass.field = field.data()->data();
        pass.corner_force = corner.data();
        const auto kernel = is_tensor_law(parameters_.law) ? kernels_.product_tensor : kernels_.product;
        team.for_range(def_.rest->blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
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
    AlignedVector<double> tangent_, fibre_tangent_;
    AlignedVector<float> block_f_;
    AlignedVector<double> block_d_;
};

}  // namespace

std::unique_ptr<Elements> make_elements(const ElementsDef& def, const ElementMaterials& materials) {
    for (const Material& material : materials.list) {
        if (same_law(material, materials.list[0])) continue;
        throw Error(ErrorCode::unsupported, "material", "the elements of one body must have the same law, rotation and matrix_regularization; only parameters may differ");
    }
    if (is_hyperelastic(materials.list[0])) return std::make_unique<HyperTets>(def, materials);
    return std::make_unique<FrameTets>(def, materials);
}

}  // namespace supple::fem
