#pragma once
#include <memory>
#include <span>
#include <vector>

#include "supple/base/parallel.h"
#include "supple/fem/corners.h"
#include "supple/fem/element_materials.h"
#include "supple/fem/tet4.h"
#include "supple/material/material.h"

namespace supple::fem {

/// Index lists of the matrix that elements are assembled into (solve::Bsr3Pattern and solve::GatherMap, which this room does not know).
struct MatrixLists {
    std::span<const std::int32_t> row_start, column, mirror;
    std::span<const std::int64_t> contribution_start;
    std::span<const std::uint32_t> contribution;
    std::size_t rows() const { return row_start.size() - 1; }
    std::size_t blocks() const { return column.size(); }
};

/// What an evaluation is asked for; null is not computed. Layouts as in Tet4Pass.
struct ElementOutputs {
    const double* plastic = nullptr;  ///< in: plastic strain of elements that flow
    double* corner_force = nullptr;
    double* energy = nullptr;
    double* stress = nullptr;
    bool tangent = false;  ///< keep what product() and assemble() need
};

/// Which matrix precision a set of elements prepares for.
enum class MatrixPrecision { none, single, double_ };

/// The elastic elements of one body, whatever their law: forces and tangent of a configuration. The body's positions and element rotations
/// stay with the caller; the tangent of the last evaluation lives here.
class Elements {
public:
    virtual ~Elements() = default;

    /// @param position    [vertex][3] [m]
    /// @param quaternion  [block][w x y z][lane], warm start in, rotations out
    virtual void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) = 0;

    /// out = K field, K the tangent of the last evaluation: float64, matrix-free. `corner` is scratch, 16 numbers per lane.
    virtual void product(Team& team, const double* quaternion, std::span<const Vec3> field, AlignedVector<double>& corner,
                         std::vector<Vec3>& out) = 0;

    /// value = stiffness_scale K + diag(diagonal_shift), [block][column][x y z 0]; in the precision given at construction.
    virtual void assemble(Team& team, double stiffness_scale, std::span<const double> diagonal_shift, float* value) = 0;
    virtual void assemble(Team& team, double stiffness_scale, std::span<const double> diagonal_shift, double* value) = 0;

    /// Whether any element can flow: then the caller keeps plastic strains, [block][xx yy zz xy yz zx][lane], zero at first.
    virtual bool is_plastic() const { return false; }
    /// Plastic flow of a step of h seconds that ended at these positions.
    virtual void flow(Team&, const double* /*position*/, double* /*quaternion*/, double* /*plastic*/, double /*h*/) {}
};

struct ElementsDef {
    const Tet4Rest* rest = nullptr;
    const CornerMap* corners = nullptr;
    MatrixLists lists;                                 ///< may be empty with MatrixPrecision::none
    MatrixPrecision precision = MatrixPrecision::none;
    Isa isa = Isa::scalar;
    bool project = true;                               ///< tangent made positive semidefinite; of hyperelastic laws where matrix_regularization says so
    bool exact_rotation = false;                       ///< corotational polar, svd: the tangent has the rotation's derivative
};

/// Elements of validated materials.
/// @error Error(unsupported) where the elements of one body have different laws
std::unique_ptr<Elements> make_elements(const ElementsDef& def, const ElementMaterials& materials);

}  // namespace supple::fem
