#pragma once
#include "supple/fem/elements.h"

namespace supple::fem {

/// Rows per chunk of an assembly.
inline constexpr std::size_t kAssemblyChunk = 512;

/// What the elements of one group are made from.
struct GroupDef {
    const ElementGroup* group = nullptr;
    MatrixPattern pattern;
    Contributions contributions;
    MatrixPrecision precision = MatrixPrecision::none;
    Isa isa = Isa::scalar;
    bool project = true;
    bool exact_rotation = false;
};

std::unique_ptr<Elements> make_frame_tets(const GroupDef& def, const ElementMaterials& materials);
std::unique_ptr<Elements> make_hyper_tets(const GroupDef& def, const ElementMaterials& materials);
std::unique_ptr<Elements> make_frame_hexes(const GroupDef& def, const ElementMaterials& materials);
std::unique_ptr<Elements> make_hyper_hexes(const GroupDef& def, const ElementMaterials& materials);

/// Small-strain moduli of a group's elements.
std::vector<Lame> group_lame(const ElementGroup& group, const ElementMaterials& materials);

/// Parameters of plastic flow as the kernels want them (Tet4Flow), for one length of step.
class PlasticFlow {
public:
    explicit PlasticFlow(std::vector<Plasticity> of_element);
    bool any() const { return !parameter_.empty(); }
    const double* parameters(double h);

private:
    std::vector<Plasticity> of_element_;
    AlignedVector<double> parameter_;  ///< [block][yield cap flow][lane]; empty where nothing flows
    double h_ = -1;
};
PlasticFlow group_plasticity(const ElementGroup& group, const ElementMaterials& materials);

/// Fills what Tet4Assembly, BlockAssembly and Hex8Assembly have in common.
template <class Assembly>
void fill_lists(Assembly& pass, const GroupDef& def, double scale, std::span<const double> shift) {
    pass.row_start = def.pattern.row_start.data();
    pass.column = def.pattern.column.data();
    pass.mirror = def.pattern.mirror.data();
    pass.contribution_start = def.contributions.start.data();
    pass.contribution = def.contributions.pair.data();
    pass.stiffness_scale = scale;
    pass.diagonal_shift = shift.empty() ? nullptr : shift.data();
}

}  // namespace supple::fem
