#include "supple/fem/element_groups.h"

#include <algorithm>
#include <optional>

#include "supple/base/assert.h"
#include "supple/fem/assembly_order.h"
#include "supple/fem/block_sums.h"
#include "supple/fem/element_passes.h"
#include "supple/fem/hyper_parameters.h"
#include "supple/fem/nodal_volume.h"
#include "supple/fem/rest.h"
#include "supple/fem/tet4_hyper.h"

namespace supple::fem {

namespace {

/// What elements keep of their lambda beside a NodalVolume; the rest goes to the vertices.
Lame kept(const Lame& lame) { return {std::min(lame.lambda_pa, lame.mu_pa), lame.mu_pa}; }

std::vector<Lame> kept(std::vector<Lame> lame, Volumetric volumetric) {
    if (volumetric == Volumetric::nodal) std::transform(lame.begin(), lame.end(), lame.begin(), [](const Lame& l) { return kept(l); });
    return lame;
}

const Material& first_material(const GroupDef& def, const ElementMaterials& materials) { return materials.of(std::size_t(def.group->element[0])); }

/// Linear elasticity in a frame: small displacements and the corotational methods.
class FrameTets final : public Elements {
public:
    FrameTets(const GroupDef& def, const ElementMaterials& materials)
        : def_(def),
          lame_(group_lame(*def.group, materials)),
          moduli_(make_moduli(def.group->tets.blocks(), kept(lame_, volumetric_of(first_material(def, materials))))),
          set_{def.group->tets, def.group->sums, moduli_, tet4_kernels(def.isa), frame_of(first_material(def, materials))},
          flow_(group_plasticity(*def.group, materials)) {
        const std::size_t lanes = set_.rest.blocks() * kBlock;
        const bool exact = def.exact_rotation && (set_.frame == Frame::polar || set_.frame == Frame::svd);
        if (exact) twist_.resize(lanes * 6);
        if (volumetric_of(first_material(def, materials)) == Volumetric::nodal) {
            std::vector<double> excess;
            for (const Lame& l : lame_) excess.push_back(l.lambda_pa - kept(l).lambda_pa);
            nodal_.emplace(set_.rest, excess);
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
        const std::vector<double> of_block = laplacian_entries(set_.rest, moduli_, def.contributions.start, def.contributions.pair);
        order_ = make_assembly_order(def.pattern, def.contributions, kAssemblyChunk);
        laplacian_.reserve(order_.block.size());
        for (const std::uint32_t block : order_.block) laplacian_.push_back(of_block[block]);
        ratio_ = common_ratio();
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
        pass.energy = outputs.energy;
        pass.stress = outputs.stress;
        pass.plastic = outputs.plastic;
        pass.project = def_.project && outputs.project;
        const auto give = [&](auto& array) { return outputs.tangent && !array.empty() ? array.data() : nullptr; };
        pass.record_f = give(record_f_);
        pass.record_d = give(record_d_);
        pass.twist = give(twist_);
        pass.twist_f = give(twist_f_);
        pass.twist_d = give(twist_d_);
        run_elements(team, set_, pass, outputs.force);
        if (nodal_ && outputs.energy != nullptr) nodal_->add_energy(outputs.energy);
    }

    std::optional<Lame> lame(std::size_t element) const override { return lame_[element]; }

    void product(Team& team, const double* quaternion, const double* field, double* value) override {
        Tet4Product pass;
        pass.quaternion = quaternion;
        pass.twist = twist_.empty() ? nullptr : twist_.data();
        pass.field = field;
        if (nodal_) {
            pass.dilatation = dilatation_.data();
            run_product(team, set_, pass);
            nodal_->pressures(team, dilatation_.data(), pressure_.data());
            pass.dilatation = nullptr;
            pass.pressure = pressure_.data();
        }
        run_product(team, set_, pass, value);
    }

    bool is_coupled() const override { return nodal_.has_value(); }
    void couple(Team& team, double scale, const float* x, float* y) override { nodal_->multiply_add(team, record_f_.data(), scale, x, y); }
    void couple(Team& team, double scale, const double* x, double* y) override { nodal_->multiply_add(team, record_d_.data(), scale, x, y); }
    void add_coupling_diagonal(Team& team, std::span<Mat3> diagonal) override {
        if (!record_f_.empty()) nodal_->add_diagonal(team, record_f_.data(), diagonal);
        if (!record_d_.empty()) nodal_->add_diagonal(team, record_d_.data(), diagonal);
    }

    bool is_plastic() const override { return flow_.any(); }

    void flow(Team& team, const double* position, double* quaternion, double* plastic, double h) override {
        if (!flow_.any()) return;
        const Tet4Flow pass{set_.rest.vertex.data(), set_.rest.gradient.data(), position, flow_.parameters(h), quaternion, plastic};
        team.for_range(set_.rest.blocks(), kBlockChunk,
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
        Tet4Assembly<Real> all;
        all.record = record.data();
        if (!twist.empty()) all.twist = twist.data();
        all.uniform = ratio_.has_value();
        all.ratio = ratio_.value_or(0);
        all.diagonal_shift = shift.empty() ? nullptr : shift.data();
        all.stiffness_scale = scale;
        all.value = value;
        team.for_range(def_.pattern.rows(), kAssemblyChunk, [&](std::size_t begin, std::size_t) {
            const AssemblyOrder::Chunk& chunk = order_.chunks[begin / kAssemblyChunk];
            Tet4Assembly<Real> pass = all;
            pass.above = chunk.diagonal - chunk.first;
            pass.diagonal = chunk.last - chunk.diagonal;
            pass.block = order_.block.data() + chunk.first;
            pass.partner = order_.partner.data() + chunk.first;
            pass.count = order_.count.data() + chunk.first;
            pass.contribution = order_.contribution.data() + chunk.contribution;
            pass.laplacian = laplacian_.data() + chunk.first;
            kernel(pass);
        });
    }

    /// lambda / mu where it is the same in all elements that have stiffness.
    std::optional<double> common_ratio() const {
        std::optional<double> common;
        for (std::size_t e = 0; e < set_.rest.elements; ++e) {
            const double* of_block = moduli_.data() + e / kBlock * 2 * kBlock + e % kBlock;
            if (!(of_block[kBlock] > 0)) continue;
            const double ratio = of_block[0] / of_block[kBlock];
            if (!common) common = ratio;
            if (!(std::abs(ratio - *common) <= 1e-12 * std::abs(*common))) return {};
        }
        return common;
    }

    GroupDef def_;
    std::vector<Lame> lame_;
    AlignedVector<double> moduli_;
    ElementSet set_;
    PlasticFlow flow_;
    std::optional<NodalVolume> nodal_;
    AlignedVector<double> dilatation_, pressure_;
    AssemblyOrder order_;
    std::vector<double> laplacian_;  ///< [block in this order] sum of mu V g_a.g_b
    std::optional<double> ratio_;    ///< lambda / mu, of all elements
    AlignedVector<float> record_f_, twist_f_;
    AlignedVector<double> record_d_, twist_d_;
    AlignedVector<double> twist_;    ///< exact tangent only
};

/// Hyperelastic laws in principal stretches.
class HyperTets final : public Elements {
public:
    HyperTets(const GroupDef& def, const ElementMaterials& materials)
        : def_(def), rest_(def.group->tets), parameters_(make_hyper_parameters(*def.group, materials)), kernels_(tet4_hyper_kernels(def.isa)) {
        const std::size_t lanes = rest_.blocks() * kBlock;
        def_.project = def.project && is_regularized(first_material(def, materials));
        tangent_.resize(lanes * (is_tensor_law(parameters_.law) ? kTensorTangent : kTangent));
        fibre_tangent_.resize(lanes * parameters_.families * kFibreTangent);
        if (def.precision == MatrixPrecision::none) return;
        sums_ = make_block_sums(def.pattern, def.contributions, rest_.blocks(), kBlockChunk);
        if (def.precision == MatrixPrecision::single) place_f_.resize(sums_.places() * 12);
        if (def.precision == MatrixPrecision::double_) place_d_.resize(sums_.places() * 12);
    }

    void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) override {
        Tet4HyperPass pass;
        pass.vertex = rest_.vertex.data();
        pass.gradient = rest_.gradient.data();
        pass.volume = rest_.volume.data();
        pass.parameter = parameters_.field.data();
        pass.parameters = parameters_.count;
        pass.fibre = parameters_.fibre.data();
        pass.families = parameters_.families;
        pass.position = position;
        pass.project = def_.project && outputs.project;
        pass.quaternion = quaternion;
        pass.energy = outputs.energy;
        pass.stress = outputs.stress;
        if (outputs.tangent) {
            pass.tangent = tangent_.data();
            pass.fibre_tangent = fibre_tangent_.data();
        }
        const auto kernel = kernels_.elements[std::size_t(parameters_.law)];
        const auto with_blocks = [&](const Tet4HyperPass& chunk, std::size_t begin, std::size_t end) {
            if (!outputs.tangent || def_.precision == MatrixPrecision::none) return kernel(chunk, begin, end);
            Tet4HyperPass inner = chunk;
            inner.corner_block = begin;
            if (!place_f_.empty()) sum_blocks(inner, begin, end, &Tet4HyperPass::block_f, place_f_.data(), kernels_.add_blocks_f);
            if (!place_d_.empty()) sum_blocks(inner, begin, end, &Tet4HyperPass::block_d, place_d_.data(), kernels_.add_blocks_d);
        };
        if (outputs.force != nullptr) return run_and_sum(team, rest_.blocks(), def_.group->sums, pass, outputs.force, with_blocks);
        team.for_range(rest_.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { with_blocks(pass, begin, end); });
    }

    std::optional<Lame> lame(std::size_t) const override { return {}; }

    void product(Team& team, const double*, const double* field, double* value) override {
        Tet4HyperProduct pass;
        pass.vertex = rest_.vertex.data();
        pass.gradient = rest_.gradient.data();
        pass.volume = rest_.volume.data();
        pass.tangent = tangent_.data();
        pass.parameter = parameters_.field.data();
        pass.parameters = parameters_.count;
        pass.fibre = parameters_.fibre.data();
        pass.fibre_tangent = fibre_tangent_.data();
        pass.families = parameters_.families;
        pass.field = field;
        const auto kernel = is_tensor_law(parameters_.law) ? kernels_.product_tensor : kernels_.product;
        run_and_sum(team, rest_.blocks(), def_.group->sums, pass, value, kernel);
    }

    void assemble(Team& team, double scale, std::span<const double> shift, float* value) override {
        assemble_rows(team, scale, shift, place_f_, value, kernels_.assemble_f);
    }
    void assemble(Team& team, double scale, std::span<const double> shift, double* value) override {
        assemble_rows(team, scale, shift, place_d_, value, kernels_.assemble_d);
    }

private:
    /// Evaluates a chunk of elements and sums their blocks.
    template <class Real, class Add>
    void sum_blocks(Tet4HyperPass& pass, std::size_t begin, std::size_t end, Real* Tet4HyperPass::* block, Real* place, Add&& add) {
        alignas(64) Real of_elements[kBlockChunk * kBlock * kElementBlocks];
        pass.*block = of_elements;
        kernels_.elements[std::size_t(parameters_.law)](pass, begin, end);
        const std::size_t chunk = begin / sums_.chunk, first = sums_.first[chunk], diagonal = sums_.diagonal[chunk], last = sums_.first[chunk + 1];
        BlockAddition<Real> sum;
        sum.count = sums_.count.data() + 2 * first;
        sum.entry = sums_.entry.data() + sums_.first_entry[chunk];
        sum.places = diagonal - first;
        sum.from = of_elements;
        sum.to = place + 12 * first;
        add(sum);
        sum.count = sums_.count.data() + 2 * diagonal;
        sum.entry = sums_.entry.data() + sums_.first_diagonal_entry[chunk];
        sum.places = last - diagonal;
        sum.from = place + 12 * first;
        sum.to = place + 12 * diagonal;
        add(sum);
    }

    template <class Real, class Kernel>
    void assemble_rows(Team& team, double scale, std::span<const double> shift, const AlignedVector<Real>& place, Real* value, Kernel kernel) {
        SUPPLE_ASSERT(!place.empty());
        BlockAssembly<Real> pass;
        fill_lists(pass, def_, scale, shift);
        pass.contribution_start = sums_.start.data();
        pass.contribution = sums_.place.data();
        pass.place = place.data();
        pass.value = value;
        team.for_range(def_.pattern.rows(), kAssemblyChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    GroupDef def_;
    const Tet4Rest& rest_;
    HyperParameters parameters_;
    const Tet4HyperKernels& kernels_;
    AlignedVector<double> tangent_, fibre_tangent_;
    BlockSums sums_;
    AlignedVector<float> place_f_;   ///< stiffness of the last evaluation, summed: [place][column 0..2][x y z 0]
    AlignedVector<double> place_d_;
};

}  // namespace

std::unique_ptr<Elements> make_frame_tets(const GroupDef& def, const ElementMaterials& materials) { return std::make_unique<FrameTets>(def, materials); }
std::unique_ptr<Elements> make_hyper_tets(const GroupDef& def, const ElementMaterials& materials) { return std::make_unique<HyperTets>(def, materials); }

}  // namespace supple::fem
