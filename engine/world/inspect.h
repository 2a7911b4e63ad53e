#pragma once
#include <Eigen/SparseCore>
#include <vector>

#include "supple/base/function_ref.h"
#include "supple/world/world.h"

namespace supple {

using MatX = Eigen::MatrixXd;
using Mat6 = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;

/// One element of a body, taken apart. Its stiffness is that of the element alone: where nodal volumes couple it to its neighbours, that part is in the
/// assembled matrix only. n corners: 4 of a tetrahedron, 8 of a hexahedron; a hexahedron's F, rotations and B are those at its centre.
struct ElementView {
    std::vector<std::int32_t> vertices;      ///< n, in the order of the mesh
    double rest_volume_m3 = 0;
    Mat3 deformation_gradient;               ///< F = dx/dX
    Mat3 initial_rotation;                   ///< frame at rest: I, or that of the rest edges where Rotation::large finds the frames
    Mat3 rotation;                           ///< R from rest to now: I (linear), the edges' (large), the polar factor of F (all others)
    std::vector<Vec3> rest_shape_m;          ///< corners from their mean
    std::vector<Vec3> rotated_rest_shape_m;  ///< R times these
    MatX strain_displacement;                ///< B, 6 x 3n [1/m]: rest displacements to strains xx yy zz xy yz zx, engineering shears
    Mat6 material_matrix;                    ///< D [Pa]: small strains to stresses in the same order; of any law, its tangent at rest
    MatX initial_stiffness;                  ///< 3n x 3n [N/m] at rest; of linear elasticity on a tetrahedron V B^T D B
    MatX stiffness;                          ///< 3n x 3n now: corotational by the world's SolverDef::tangent, of all others the consistent tangent; not projected
    double energy_j = 0;                     ///< elastic
    Voigt cauchy_pa{};
};

struct BoundingBox {
    Vec3 min_m = Vec3::Zero(), max_m = Vec3::Zero();
};

/// The matrices of a body's equations of motion, 3 rows per vertex (x y z), no supports applied.
enum class SystemMatrix {
    mass,       ///< M, lumped [kg]
    stiffness,  ///< K = -df/dx of the elements now [N/m], as ElementView::stiffness
    damping,    ///< C = rayleigh_mass_1_s M + rayleigh_stiffness_s K [N s/m]
};

/// Takes one number of a matrix.
using MatrixSink = FunctionRef<void(Eigen::Index row, Eigen::Index column, double value)>;

/// Looks into a body as it stands when a function is called. Changes nothing; slow and plain, in float64. The world must outlive it.
class Inspector {
public:
    /// @error Error(stale_id)
    Inspector(const World& world, BodyId body);

    std::size_t element_count() const;
    /// @error Error(invalid_argument) beyond element_count()
    ElementView element(std::size_t element) const;

    /// Rotation of every element from rest to now, as ElementView::rotation.
    std::vector<Mat3> element_rotations() const;
    /// Rotation of every vertex: mean of its elements' weighted by rest volume, projected on the rotations; I at a vertex of no element.
    std::vector<Mat3> vertex_rotations() const;
    BoundingBox bounding_box() const;  ///< of the vertices that elements use

    Eigen::Index rows() const;         ///< of the matrices: 3 per vertex
    /// Calls sink(row_offset + i, column_offset + j, factor * value) for the stored numbers of a matrix. An (i, j) comes once, except with
    /// nodal volumes (nearly incompressible tetrahedra), whose wide part comes first, column by column: there, numbers of one place add up, and it takes a
    /// pass over the body per column.
    void add(SystemMatrix which, double factor, Eigen::Index row_offset, Eigen::Index column_offset, MatrixSink sink) const;
    /// matrix += factor * the body's, with its upper left corner at the offsets.
    /// @error Error(invalid_argument) if it does not fit
    void add_to(SystemMatrix which, double factor, Eigen::Index row_offset, Eigen::Index column_offset, Eigen::SparseMatrix<double>& matrix) const;
    void add_to(SystemMatrix which, double factor, Eigen::Index row_offset, Eigen::Index column_offset, Eigen::Ref<MatX> matrix) const;
    Eigen::SparseMatrix<double> matrix(SystemMatrix which) const;

private:
    friend class BodyResponse;
    World::Impl& impl() const { return *world_->impl_; }
    const World* world_;
    BodyId body_;
};

}  // namespace supple
