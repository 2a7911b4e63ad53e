#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "supple/base/parallel.h"
#include "supple/fem/element_layout.h"
#include "supple/fem/element_products.h"
#include "supple/material/material.h"

namespace supple::fem {

/// Index lists of the matrix that elements are assembled into (solve::Bsr3Pattern, which this room does not know).
struct MatrixPattern {
    std::span<const std::int32_t> row_start, column, mirror;
    std::span<const std::int32_t> row{};  ///< [vertex] its row; for products without the matrix
    std::size_t rows() const { return row_start.size() - 1; }
    std::size_t blocks() const { return column.size(); }
};

/// Which pairs of corners of a group's elements make up each block (solve::GatherMap).
struct Contributions {
    std::span<const std::int64_t> start;
    std::span<const std::uint32_t> pair;
};

/// What an evaluation is asked for; null is not computed. Layouts as in Tet4Pass, all groups one after the other (ElementLayout).
struct ElementOutputs {
    const double* plastic = nullptr;  ///< in: plastic strain of elements that flow
    double* force = nullptr;          ///< elastic forces at the layout's places, [place][x y z 0] [N]: to be gathered (fem::gather)
    double* energy = nullptr;
    double* stress = nullptr;
    bool tangent = false;  ///< keep what product() and assemble() need
    bool project = true;   ///< where ElementsDef::project says so, too; false: the derivative as it is, which may be indefinite
};

/// Which matrix precision a set of elements prepares for.
enum class MatrixPrecision { none, single, double_ };

/// The elastic elements of one body, whatever their kinds and laws: forces and tangent of a configuration. The body's positions and element
/// rotations stay with the caller; the tangent of the last evaluation lives here. One group of elements is one of these; several are one again.
class Elements {
public:
    virtual ~Elements() = default;

    /// @param position    [vertex][3] [m]
    /// @param quaternion  [block][w x y z][lane], warm start in, rotations out
    virtual void evaluate(Team& team, const double* position, double* quaternion, const ElementOutputs& outputs) = 0;

    /// Lame parameters at work in an element (in the order of the mesh) where the law is linear elasticity in a frame; none for strain energies in F.
    virtual std::optional<Lame> lame(std::size_t element) const = 0;

    /// K field, K the tangent of the last evaluation, element by element: float64, matrix-free.
    /// @param value  out [place][x y z 0]: to be gathered (fem::gather)
    virtual void product(Team& team, const double* quaternion, const double* field, double* value) = 0;

    /// value = stiffness_scale K + diag(diagonal_shift), [block][column][x y z 0]; in the precision given at construction.
    /// With an empty diagonal_shift stiffness_scale K is added to what is there.
    virtual void assemble(Team& team, double stiffness_scale, std::span<const double> diagonal_shift, float* value) = 0;
    virtual void assemble(Team& team, double stiffness_scale, std::span<const double> diagonal_shift, double* value) = 0;

    /// Whether products() can take the matrix's place, and whether it is the faster of the two.
    virtual bool has_products() const { return false; }
    virtual bool prefers_products() const { return false; }
    /// The tangent of the last evaluation as an operator, in the precision given at construction. The first call allocates; what it gives back is good until the next evaluation with a tangent.
    /// @pre has_products()   @param factor  of the stiffness
    virtual ElementProducts<float>* products(Team&, const double* /*quaternion*/, double /*factor*/, float /*precision*/) { return nullptr; }
    virtual ElementProducts<double>* products(Team&, const double* /*quaternion*/, double /*factor*/, double /*precision*/) { return nullptr; }

    /// Whether a part of the tangent is too wide for the matrix's pattern (NodalVolume): assemble() leaves it out, product() has it.
    virtual bool is_coupled() const { return false; }
    /// y += scale times that part times x, [vertex][x y z 0]; needs the precision given at construction.
    virtual void couple(Team&, double /*scale*/, const float* /*x*/, float* /*y*/) {}
    virtual void couple(Team&, double /*scale*/, const double* /*x*/, double* /*y*/) {}
    /// Adds its diagonal blocks [N/m], one per vertex.
    virtual void add_coupling_diagonal(Team&, std::span<Mat3> /*diagonal*/) {}

    /// Whether any element can flow: then the caller keeps plastic strains, [block][xx yy zz xy yz zx][lane], zero at first.
    virtual bool is_plastic() const { return false; }
    /// Plastic flow of a step of h seconds that ended at these positions.
    virtual void flow(Team&, const double* /*position*/, double* /*quaternion*/, double* /*plastic*/, double /*h*/) {}
};

/// Materials of a body's elements: one for all, or several and the index of each element's.
struct ElementMaterials {
    std::vector<Material> materials;                ///< at least one, validated (check_material)
    std::vector<std::int32_t> material_of_element;  ///< empty (all have the first), or one per element of the mesh
    std::vector<double> stiffness_factor;           ///< empty (1), or one per element of the mesh: multiplies every modulus in pascals

    std::size_t index(std::size_t element) const { return material_of_element.empty() ? 0 : std::size_t(material_of_element[element]); }
    const Material& of(std::size_t element) const { return materials[index(element)]; }
    double factor(std::size_t element) const { return stiffness_factor.empty() ? 1.0 : stiffness_factor[element]; }
    /// Small-strain moduli of an element, its factor included.
    Lame lame_of(std::size_t element) const;
    /// Of the elements' laws; elements of one kind and family are one group. All that may differ inside a family are numbers.
    std::vector<std::int32_t> families(std::size_t elements) const;
};

struct ElementsDef {
    const ElementLayout* layout = nullptr;     ///< grouped by ElementMaterials::families(); outlives the elements
    MatrixPattern pattern;                     ///< may be empty with MatrixPrecision::none, like the next
    std::vector<Contributions> contributions;  ///< one per group
    MatrixPrecision precision = MatrixPrecision::none;
    Isa isa = Isa::scalar;
    bool project = true;                       ///< tangent made positive semidefinite; of hyperelastic laws where matrix_regularization says so
    bool exact_rotation = false;               ///< corotational, polar or svd: the tangent has the rotation's derivative (of hexes that of their mean strain)
};

/// @error Error(invalid_argument) for a hexahedron whose map is folded at an integration point
std::unique_ptr<Elements> make_elements(const ElementsDef& def, const ElementMaterials& materials);

/// out = K field: product() and the gather. `corner` is scratch, 4 numbers per place.
void stiffness_product(Team& team, Elements& elements, const ElementLayout& layout, const double* quaternion, std::span<const Vec3> field,
                       AlignedVector<double>& corner, std::vector<Vec3>& out);

}  // namespace supple::fem
