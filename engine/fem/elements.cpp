#include "supple/fem/element_groups.h"

#include "supple/base/assert.h"
#include "supple/fem/element_passes.h"
#include "supple/fem/hyper_parameters.h"
#include "supple/fem/rest.h"
#include "supple/fem/tet4_hyper.h"

namespace supple::fem {

namespace {

/// Linear elasticity in a frame: small displacements and the corotational methods.
class FrameTets final : public Elements {
public:
    FrameTets(const GroupDef& def, const ElementMaterials& materials)
        : def_(def),
          moduli_(make_moduli(def.group->tets.blocks(), group_lame(*def.group, materials))),
          set_{def.group->tets, moduli_, tet4_kernels(def.isa), frame_of(materials.of(std::size_t(def.group->element[0])))} {
        const std::size_t records = set_.rest.blocks() * kBlock * kRecord;
        if (def.precision == MatrixPrecision::single) record_f_.resize(records);
        if (def.precision == MatrixPrecision::double_) record_d_.resize(records);
        if (def.precision == MatrixPrecision::none) return;
        laplacian_.assign(def.pattern.blocks(), 0.0);
        for (std::size_t b = 0; b < laplacian_.size(); ++b) {
            for (std::int64_t i = def.contributions.start[b]; i < def.contributions.start[b + 1]; ++i) {
                laplacian_[b] += laplacian_entry(set_.rest, moduli_, def.contributions.pair[std::size_t(i)]);
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
        if (outputs.tangent && !record_f_.empty()) pass.record_f = record_f_.data();
        if (outputs.tangent && !record_d_.empty()) pass.record_d = record_d_.data();
        run_elements(team, set_, pass);
    }

    void product(Team& team, const double* quaternion, const double* field, double* corner_value) override {
        stiffness_product(team, set_, quaternion, field, corner_value);
    }

    void assemble(Team& team, double scale, std::span<const double> shift, float* value) override {
        assemble_rows(team, scale, shift, record_f_, value, set_.kernels.assemble_f);
    }
    void assemble(Team& team, double scale, std::span<const double> shift, double* value) override {
        assemble_rows(team, scale, shift, record_d_, value, set_.kernels.assemble_d);
    }

private:
    template <class Real, class Kernel>
    void assemble_rows(Team& team, double scale, std::span<const double> shift, const AlignedVector<Real>& record, Real* value, Kernel kernel) {
        SUPPLE_ASSERT(!record.empty());
        Tet4Assembly<Real> pass;
        fill_lists(pass, def_, scale, shift);
        pass.record = record.data();
        pass.laplacian = laplacian_.data();
        pass.value = value;
        team.for_range(def_.pattern.rows(), kAssemblyChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    GroupDef def_;
    AlignedVector<double> moduli_;
    ElementSet set_;
    std::vector<double> laplacian_;  ///< [matrix block] sum of mu V g_a.g_b
    AlignedVector<float> record_f_;
    AlignedVector<double> record_d_;
};

/// Hyperelastic laws in principal stretches.
class HyperTets final : public Elements {
public:
    HyperTets(const GroupDef& def, const ElementMaterials& materials)
        : def_(def), rest_(def.group->tets), parameters_(make_hyper_parameters(*def.group, materials)), kernels_(tet4_hyper_kernels(def.isa)) {
        const std::size_t lanes = rest_.blocks() * kBlock;
        tangent_.resize(lanes * kTangent);
        if (def.precision == MatrixPrecision::single) block_f_.resize(lanes * kElementBlocks);
        if (def.precision == MatrixPrecision::double_) block_d_.resize(lanes * kElementBlocks);
    }

    void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) override {
        Tet4HyperPass pass;
        pass.vertex = rest_.vertex.data();
        pass.gradient = rest_.gradient.data();
        pass.volume = rest_.volume.data();
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
        team.for_range(rest_.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    void product(Team& team, const double*, const double* field, double* corner_value) override {
        const Tet4HyperProduct pass{rest_.vertex.data(), rest_.gradient.data(), rest_.volume.data(), tangent_.data(), field, corner_value};
        team.for_range(rest_.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernels_.product(pass, begin, end); });
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
        fill_lists(pass, def_, scale, shift);
        pass.block = block.data();
        pass.value = value;
        team.for_range(def_.pattern.rows(), kAssemblyChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    GroupDef def_;
    const Tet4Rest& rest_;
    HyperParameters parameters_;
    const Tet4HyperKernels& kernels_;
    AlignedVector<double> tangent_;
    AlignedVector<float> block_f_;
    AlignedVector<double> block_d_;
};

}  // namespace

std::unique_ptr<Elements> make_frame_tets(const GroupDef& def, const ElementMaterials& materials) { return std::make_unique<FrameTets>(def, materials); }
std::unique_ptr<Elements> make_hyper_tets(const GroupDef& def, const ElementMaterials& materials) { return std::make_unique<HyperTets>(def, materials); }

}  // namespace supple::fem
