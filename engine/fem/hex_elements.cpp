#include "supple/base/assert.h"
#include "supple/base/error.h"
#include "supple/fem/element_groups.h"
#include "supple/fem/element_passes.h"
#include "supple/fem/hex8_hyper.h"
#include "supple/fem/hex8_kernels.h"
#include "supple/fem/hex8_products.h"
#include "supple/fem/hex8_stiffness.h"
#include "supple/fem/hyper_parameters.h"
#include "supple/fem/rest.h"

namespace supple::fem {

namespace {

std::vector<Integration> group_integration(const ElementGroup& group, const ElementMaterials& materials) {
    std::vector<Integration> integration;
    for (const std::int32_t e : group.element) {
        const Material& material = materials.of(std::size_t(e));
        const auto* corotational = std::get_if<Corotational>(&material);
        integration.push_back(corotational != nullptr ? corotational->integration : std::get<Linear>(material).integration);
    }
    return integration;
}

/// Linear elasticity in a frame: small displacements and the corotational methods.
class FrameHexes final : public Elements {
public:
    FrameHexes(const GroupDef& def, const ElementMaterials& materials)
        : def_(def),
          rest_(def.group->hexes),
          frame_(frame_of(materials.of(std::size_t(def.group->element[0])))),
          kernels_(hex8_kernels(def.isa)),
          flow_(group_plasticity(*def.group, materials)) {
        lame_ = group_lame(*def.group, materials);
        moduli_ = make_moduli(rest_.blocks(), lame_);
        stiffness_ = make_hex_stiffness(rest_, lame_, group_integration(*def.group, materials), def.precision == MatrixPrecision::single);
        shared_part_ = shared_part(stiffness_);
        const std::size_t lanes = rest_.blocks() * kBlock;
        const bool exact = def.exact_rotation && (frame_ == Frame::polar || frame_ == Frame::svd);
        if (exact) twist_.resize(lanes * 6);
        if (def.precision == MatrixPrecision::single) {
            record_f_.resize(lanes * kHexRecord);
            if (exact) twist_f_.resize(lanes * kHexTwist);
        }
        if (def.precision == MatrixPrecision::double_) {
            record_d_.resize(lanes * kHexRecord);
            if (exact) twist_d_.resize(lanes * kHexTwist);
        }
    }

    void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) override {
        Hex8Pass pass;
        pass.vertex = rest_.vertex.data();
        pass.edge = rest_.edge.data();
        pass.gradient = rest_.gradient.data();
        pass.volume = rest_.volume.data();
        pass.moduli = moduli_.data();
        pass.stiffness = view();
        pass.position = position;
        pass.quaternion = quaternion;
        pass.corner_force = outputs.force;
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
        const auto kernel = kernels_.elements[std::size_t(frame_)];
        team.for_range(rest_.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    std::optional<Lame> lame(std::size_t element) const override { return lame_[element]; }

    void product(Team& team, const double* quaternion, const double* field, double* corner_value) override {
        const Hex8Product pass{rest_.vertex.data(), rest_.gradient.data(), view(), twist_.empty() ? nullptr : twist_.data(), quaternion, field, corner_value};
        team.for_range(rest_.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernels_.product(pass, begin, end); });
    }

    bool has_products() const override { return !def_.pattern.row.empty(); }
    // A group of several shapes reads a stiffness per lane: some 28 kB for what one shape has in 2. Four lanes or one are too few to outrun the matrix (tests/bench/README.md).
    bool prefers_products() const override { return has_products() && shared_part_ > kSharedEnough && (def_.isa == Isa::avx2 || def_.isa == Isa::avx512); }
    ElementProducts<float>* products(Team& team, const double* quaternion, double factor, float) override { return turned(products_f_, team, quaternion, factor); }
    ElementProducts<double>* products(Team& team, const double* quaternion, double factor, double) override { return turned(products_d_, team, quaternion, factor); }

    bool is_plastic() const override { return flow_.any(); }

    void flow(Team& team, const double* position, double* quaternion, double* plastic, double h) override {
        if (!flow_.any()) return;
        const Hex8Flow pass{rest_.vertex.data(), rest_.edge.data(), rest_.gradient.data(), position, flow_.parameters(h), quaternion, plastic};
        const auto kernel = kernels_.flow[std::size_t(frame_)];
        team.for_range(rest_.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    void assemble(Team& team, double scale, std::span<const double> shift, float* value) override {
        assemble_rows(team, scale, shift, stiffness_.shared_f, record_f_, twist_f_, value, kernels_.assemble_f);
    }
    void assemble(Team& team, double scale, std::span<const double> shift, double* value) override {
        assemble_rows(team, scale, shift, stiffness_.shared_d, record_d_, twist_d_, value, kernels_.assemble_d);
    }

private:
    HexStiffnessView view() const { return {stiffness_.shared_d.data(), stiffness_.own.data(), stiffness_.place.data(), stiffness_.scale.data()}; }

    static constexpr double kSharedEnough = 0.75;

    template <class Real>
    ElementProducts<Real>* turned(std::unique_ptr<HexProducts<Real>>& products, Team& team, const double* quaternion, double factor) {
        SUPPLE_ASSERT(has_products());
        if (!products) products = std::make_unique<HexProducts<Real>>(rest_, stiffness_, def_.pattern.row, def_.isa);
        products->turn(team, quaternion, twist_.empty() ? nullptr : twist_.data(), stiffness_, factor);
        return products.get();
    }

    template <class Real, class Kernel>
    void assemble_rows(Team& team, double scale, std::span<const double> shift, const AlignedVector<Real>& stiffness, const AlignedVector<Real>& record,
                       const AlignedVector<Real>& twist, Real* value, Kernel kernel) {
        SUPPLE_ASSERT(!record.empty());
        Hex8Assembly<Real> pass;
        fill_lists(pass, def_, scale, shift);
        pass.stiffness = stiffness.data();
        pass.class_of = stiffness_.class_of.data();
        pass.record = record.data();
        if (!twist.empty()) pass.twist = twist.data();
        pass.value = value;
        team.for_range(def_.pattern.rows(), kAssemblyChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    GroupDef def_;
    const Hex8Rest& rest_;
    Frame frame_;
    const Hex8Kernels& kernels_;
    std::vector<Lame> lame_;
    AlignedVector<double> moduli_;
    HexStiffness stiffness_;
    double shared_part_ = 0;
    std::unique_ptr<HexProducts<float>> products_f_;
    std::unique_ptr<HexProducts<double>> products_d_;
    PlasticFlow flow_;
    AlignedVector<double> twist_;       ///< of the last tangent; only where it is exact
    AlignedVector<float> record_f_, twist_f_;
    AlignedVector<double> record_d_, twist_d_;
};

/// Hyperelastic laws, with one volume ratio per element.
class HyperHexes final : public Elements {
public:
    HyperHexes(const GroupDef& def, const ElementMaterials& materials)
        : def_(def),
          rest_(def.group->hexes),
          points_(make_hex_points(rest_)),
          parameters_(make_hyper_parameters(*def.group, materials)),
          kernel_(hex8_hyper_kernels(def.isa).elements[std::size_t(parameters_.law)]),
          kernels_(hex8_kernels(def.isa)) {
        const Material& first = materials.of(std::size_t(def.group->element[0]));
        def_.project = def.project && is_regularized(first);
        const std::size_t lanes = rest_.blocks() * kBlock;
        inner_.resize(lanes * kHexInner);
        for (std::size_t block = 0; block < rest_.blocks(); ++block) place_.push_back(-1 - std::int64_t(block));
        if (def.precision == MatrixPrecision::single) block_f_.resize(lanes * kHexBlocks);
        if (def.precision == MatrixPrecision::double_) block_d_.resize(lanes * kHexBlocks);
    }

    void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) override {
        Hex8HyperPass pass;
        pass.vertex = rest_.vertex.data();
        pass.gradient = rest_.gradient.data();
        pass.volume = rest_.volume.data();
        pass.point = points_.data();
        pass.parameter = parameters_.field.data();
        pass.parameters = parameters_.count;
        pass.fibre = parameters_.fibre.data();
        pass.families = parameters_.families;
        pass.position = position;
        pass.project = def_.project && outputs.project;
        pass.quaternion = quaternion;
        pass.corner_force = outputs.force;
        pass.energy = outputs.energy;
        pass.stress = outputs.stress;
        if (outputs.tangent) {
            pass.inner = inner_.data();
            if (!block_f_.empty()) pass.block_f = block_f_.data();
            if (!block_d_.empty()) pass.block_d = block_d_.data();
        }
        team.for_range(rest_.blocks(), kHyperChunk, [&](std::size_t begin, std::size_t end) { kernel_(pass, begin, end); });
    }

    std::optional<Lame> lame(std::size_t) const override { return {}; }

    void product(Team& team, const double*, const double* field, double* corner_value) override {
        const Hex8Product pass{rest_.vertex.data(), nullptr, {nullptr, inner_.data(), place_.data(), nullptr}, nullptr, nullptr, field, corner_value};
        team.for_range(rest_.blocks(), kBlockChunk, [&](std::size_t begin, std::size_t end) { kernels_.product(pass, begin, end); });
    }

    void assemble(Team& team, double scale, std::span<const double> shift, float* value) override {
        assemble_rows(team, scale, shift, block_f_, value, kernels_.assemble_f);
    }
    void assemble(Team& team, double scale, std::span<const double> shift, double* value) override {
        assemble_rows(team, scale, shift, block_d_, value, kernels_.assemble_d);
    }

private:
    static constexpr std::size_t kHyperChunk = 4;  ///< blocks: eight points each, and the stiffness

    template <class Real, class Kernel>
    void assemble_rows(Team& team, double scale, std::span<const double> shift, const AlignedVector<Real>& blocks, Real* value, Kernel kernel) {
        SUPPLE_ASSERT(!blocks.empty());
        Hex8Assembly<Real> pass;
        fill_lists(pass, def_, scale, shift);
        pass.stiffness = blocks.data();
        pass.value = value;
        team.for_range(def_.pattern.rows(), kAssemblyChunk, [&](std::size_t begin, std::size_t end) { kernel(pass, begin, end); });
    }

    GroupDef def_;
    const Hex8Rest& rest_;
    AlignedVector<double> points_;
    HyperParameters parameters_;
    void (*kernel_)(const Hex8HyperPass& pass, std::size_t begin, std::size_t end);
    const Hex8Kernels& kernels_;
    AlignedVector<double> inner_;       ///< tangent of the last evaluation, [block][kHexInner][lane]
    std::vector<std::int64_t> place_;   ///< [block] where it lies, for the product kernel
    AlignedVector<float> block_f_;
    AlignedVector<double> block_d_;
};

}  // namespace

std::unique_ptr<Elements> make_frame_hexes(const GroupDef& def, const ElementMaterials& materials) { return std::make_unique<FrameHexes>(def, materials); }

std::unique_ptr<Elements> make_hyper_hexes(const GroupDef& def, const ElementMaterials& materials) { return std::make_unique<HyperHexes>(def, materials); }

}  // namespace supple::fem
