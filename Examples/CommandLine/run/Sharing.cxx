// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Sharing.h"

#include "Job.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "Text.h"

#if MCOR_HAS_RANKS
#include "vtkAppendPolyData.h"
#include "vtkFieldData.h"
#include "vtkMPIController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSPHFound.h"
#include "vtkSPHRanksWait.h"
#endif

#include <cstdlib>
#include <stdexcept>

namespace
{

#if MCOR_HAS_RANKS
/// Begins and ends MPI, for the processes of mpirun that share a job. There is one object per
/// process. All processes read pieces of a file; the first reads a file without pieces. Each writes
/// its piece of a surface to a .pvtp file; the first writes the whole surface to any other file.
class RankSession : public Sharing
{
public:
  explicit RankSession(Job& job)
    : Sharing(job)
    , Periodic(job.Periodic)
    , DetectPeriod(job.DetectPeriod)
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

  Particles Read() override
  {
    return this->Options.Walls.empty() ? this->Part(this->Options.Inputs.front(), false)
                                       : this->Share([this] { return Sharing::Read(); }, false);
  }

  /// Reads a stored time as for a single surface; a time between two steps is read by the first
  /// process.
  Particles Read(ParticleTimes& times, double time, std::vector<std::string>& warnings) override
  {
    this->Options.Periodic = this->Periodic; // each time may have another period
    this->Options.DetectPeriod = this->DetectPeriod;
    const ParticleTimes::Step* step = times.GetStored(time);
    if (step && step->Files.size() == 1 && step->Walls.empty())
    {
      return this->Part(step->Files.front(), true);
    }
    return this->Share(
      [&]
      {
        return step ? AddWalls(ReadParticles(step->Files, true), ReadWalls(step->Walls))
                    : times.At(time, warnings);
      },
      true);
  }

  /// Sorts the parts by GlobalPointIds and GlobalCellIds, and drops these arrays.
  vtkSmartPointer<vtkPolyData> Merge(vtkPolyData* part) override
  {
    return vtkSPHMergeSurface(this->Controller, part);
  }

  vtkSmartPointer<vtkPolyData> Append(vtkPolyData* particles) override
  {
    std::vector<vtkSmartPointer<vtkDataObject>> parts;
    vtkNew<vtkAppendPolyData> append;
    vtkSPHAwaitRanks(this->Controller);
    this->Controller->Gather(particles, parts, 0);
    for (const auto& part : parts)
    {
      append->AddInputData(vtkPolyData::SafeDownCast(part));
    }
    if (this->IsFirst())
    {
      append->Update(); // sorts the arrays by their names
      vtkNew<vtkPointData> inOrder;
      for (int a = 0; a < particles->GetPointData()->GetNumberOfArrays(); ++a)
      {
        inOrder->AddArray(append->GetOutput()->GetPointData()->GetAbstractArray(
          particles->GetPointData()->GetArrayName(a)));
      }
      append->GetOutput()->GetPointData()->ShallowCopy(inOrder);
      append->GetOutput()->GetFieldData()->ShallowCopy(particles->GetFieldData());
    }
    return append->GetOutput();
  }

private:
  /// Part() returns the particles that this process reads from a file. Share() returns all
  /// particles that make() gives on the first process, and none on others. mayBeEmpty: whether all
  /// processes together may have none.
  Particles Part(const std::string& file, bool mayBeEmpty)
  {
    Particles particles;
    ParticleSets sets;
    this->OnAll([&] { sets = ReadSets({ file }, this->GetRank(), this->GetCount()); });
    const int own = sets.HaveVertices ? 1 : 0;
    int any = own;
    this->Controller->AllReduce(&own, &any, 1, vtkCommunicator::MAX_OP);
    sets.HaveVertices = any > 0;
    this->OnAll([&] { particles = JoinSets(sets); });
    return this->Complete(particles, mayBeEmpty);
  }

  Particles Share(const std::function<Particles()>& make, bool mayBeEmpty)
  {
    Particles particles = vtkSmartPointer<vtkPolyData>::New();
    this->OnFirst([&] { particles = make(); });
    return this->Complete(particles, mayBeEmpty);
  }

  /// Processes without particles get the others' arrays, without values, so that a name in the
  /// options means the same on all processes. Finds the period of all processes' particles.
  Particles Complete(vtkPointSet* particles, bool mayBeEmpty)
  {
    const vtkIdType own = particles->GetNumberOfPoints();
    vtkIdType all = own;
    this->Controller->AllReduce(&own, &all, 1, vtkCommunicator::SUM_OP);
    Require(all > 0 || mayBeEmpty, "the input holds no points");
    vtkNew<vtkPolyData> form;
    if (own > 0)
    {
      form->SetPoints(particles->GetPoints());
      form->GetPointData()->ShallowCopy(particles->GetPointData());
    }
    vtkSPHMatchEmpty(this->Controller, form);
    const Particles complete = own > 0 || all == 0 ? particles : form.Get();
    Job& job = this->Options;
    if (job.DetectPeriod) // field data tell the period
    {
      std::string problem;
      const vtkSPHPeriod found =
        vtkSPHFindPeriodDistributed(this->Controller, complete->GetFieldData(), problem);
      this->OnAll([&] { job.Periodic = CheckedPeriod(found, problem); });
      job.DetectPeriod = false;
    }
    if (job.Periodic.size() == 3) // lengths; the particles tell where the period begins
    {
      job.Periodic = vtkSPHBoundsOfPeriodDistributed(this->Controller, job.Periodic, complete);
    }
    return complete;
  }

  vtkNew<vtkMPIController> Controller;
  const std::vector<double> Periodic; ///< the job's own setting
  const bool DetectPeriod;
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

Sharing::Particles Sharing::Read()
{
  return AddWalls(ReadParticles(this->Options.Inputs), ReadWalls(this->Options.Walls));
}

Sharing::Particles Sharing::Read(
  ParticleTimes& times, double time, std::vector<std::string>& warnings)
{
  return times.At(time, warnings);
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
