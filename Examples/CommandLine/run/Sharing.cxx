// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Sharing.h"

#include "Job.h"
#include "ParticleFile.h"
#include "Text.h"

#if MCOR_HAS_RANKS
#include "vtkMPIController.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkSPHBlocks.h"
#include "vtkSPHFound.h"
#include "vtkSPHRanksWait.h"
#endif

#include <cstdlib>
#include <stdexcept>

namespace
{

#if MCOR_HAS_RANKS
/// Begins and ends MPI, for the processes of mpirun that share a job. There is one object per
/// process. All processes read the pieces of a list, or the files of a snapshot; the first process reads
/// any other file. All write the pieces of a .pvtp file; the first process writes the whole surface to any other file.
class RankSession : public Sharing
{
public:
  explicit RankSession(Job& job)
    : Sharing(job)
    , Periodic(job.Periodic)
  {
    int count = 0;
    char** none = nullptr;
    this->Controller->Initialize(&count, &none, 0);
    vtkMultiProcessController::SetGlobalController(this->Controller);
    for (vtkSPHAlgorithm* filter : job.All())
    {
      filter->SetController(this->Controller); // filters were made before MPI began
    }
  }

  ~RankSession() override
  {
    for (vtkSPHAlgorithm* filter : this->Options.All())
    {
      filter->SetController(nullptr);
    }
    vtkMultiProcessController::SetGlobalController(nullptr);
    this->Controller->Finalize();
  }

  int GetRank() const override { return this->Controller->GetLocalProcessId(); }
  int GetCount() const override { return this->Controller->GetNumberOfProcesses(); }

  void OnAll(const std::function<void()>& work) override
  {
    std::string sentence = FailureOf(work);
    const int self = sentence.empty() ? this->GetCount() : this->GetRank();
    int failed = self;
    vtkSPHAwaitRanks(this->Controller);
    this->Controller->AllReduce(&self, &failed, 1, vtkCommunicator::MIN_OP);
    if (failed == this->GetCount())
    {
      return;
    }
    vtkIdType size = static_cast<vtkIdType>(sentence.size());
    this->Controller->Broadcast(&size, 1, failed);
    sentence.resize(static_cast<std::size_t>(size));
    this->Controller->Broadcast(&sentence[0], size, failed);
    throw std::runtime_error(sentence);
  }

  /// Processes without particles get the others' arrays, without values, so that a name in the
  /// options means the same on all processes. Finds the period of all processes' particles.
  Particles Read(
    const std::string& file, bool mayBeEmpty, const std::function<Particles()>& read) override
  {
    Particles particles = vtkSmartPointer<vtkPolyData>::New();
    if (file.empty())
    {
      this->OnFirst([&] { particles = read(); });
    }
    else
    {
      ParticleSets sets;
      this->OnAll([&] { sets = ReadSets({ file }, this->GetRank(), this->GetCount()); });
      const int own = sets.HaveVertices ? 1 : 0;
      int any = own;
      this->Controller->AllReduce(&own, &any, 1, vtkCommunicator::MAX_OP);
      sets.HaveVertices = any > 0;
      this->OnAll([&] { particles = JoinSets(sets, !this->IsFirst()); });
    }
    const vtkIdType own = particles->GetNumberOfPoints();
    vtkIdType all = own;
    this->Controller->AllReduce(&own, &all, 1, vtkCommunicator::SUM_OP);
    Require(all > 0 || mayBeEmpty, "the input holds no points");
    if (all > 0)
    {
      vtkSPHMatchEmpty(this->Controller, vtkPolyData::SafeDownCast(particles));
    }
    Job& job = this->Options;
    job.Periodic = this->Periodic; // each time may have another period
    if (job.DetectPeriod)          // field data tell the period
    {
      std::string problem;
      const vtkSPHPeriod found =
        vtkSPHFindPeriodDistributed(this->Controller, particles->GetFieldData(), problem);
      this->OnAll([&] { job.Periodic = CheckedPeriod(found, problem); });
    }
    if (job.Periodic.size() == 3) // lengths; the particles tell where the period begins
    {
      job.Periodic = vtkSPHBoundsOfPeriodDistributed(this->Controller, job.Periodic, particles);
    }
    return particles;
  }

  /// Joins the parts in the order of GlobalPointIds and GlobalCellIds, and drops these arrays.
  vtkSmartPointer<vtkPolyData> Merge(vtkPolyData* part) override
  {
    return vtkSPHMergeSurface(this->Controller, part);
  }

  Particles Append(vtkPointSet* particles) override
  {
    std::vector<vtkSmartPointer<vtkDataObject>> parts;
    vtkNew<vtkMultiBlockDataSet> blocks;
    vtkSPHAwaitRanks(this->Controller);
    this->Controller->Gather(particles, parts, 0);
    for (const auto& part : parts)
    {
      blocks->SetBlock(blocks->GetNumberOfBlocks(), part);
    }
    const Particles all = vtkSPHJoinBlocks(blocks);
    all->SetFieldData(particles->GetFieldData());
    return all;
  }

private:
  vtkNew<vtkMPIController> Controller;
  const std::vector<double> Periodic; ///< the job's own setting
};
#endif

/// Returns the first of these environment variables that is set, as a number.
[[maybe_unused]] int Number(const char* ofOpenMpi, const char* ofOthers, int otherwise)
{
  const char* text = std::getenv(ofOpenMpi);
  text = text ? text : std::getenv(ofOthers);
  return text ? std::atoi(text) : otherwise;
}

}

Sharing::Particles Sharing::ReadInput()
{
  const Job& job = this->Options;
  return this->Read(job.Walls.empty() ? job.Inputs.front() : "", false,
    [&job] { return AddWalls(ReadParticles(job.Inputs), ReadWalls(job.Walls)); });
}

int LaunchedCount()
{
#if MCOR_HAS_RANKS
  return Number("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", 1);
#else
  return 1;
#endif
}

int LaunchedRank()
{
  return LaunchedCount() > 1 ? Number("OMPI_COMM_WORLD_RANK", "PMI_RANK", 0) : 0;
}

std::unique_ptr<Sharing> NewRankSession([[maybe_unused]] Job& job)
{
#if MCOR_HAS_RANKS
  return std::make_unique<RankSession>(job);
#else
  return nullptr;
#endif
}
