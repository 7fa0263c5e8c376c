// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHTemporalInterpolator.h"

#include "vtkAlgorithmOutput.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHBlocks.h"
#include "vtkSPHFound.h"
#include "vtkSPHPrint.h"
#include "vtkSPHTemporalPair.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
using Pipeline = vtkStreamingDemandDrivenPipeline;

class vtkSPHTemporalInterpolator::vtkInternals
{
public:
  vtkDataObject* Find(double time) const
  {
    const auto found = this->Kept.find(time);
    return found == this->Kept.end() ? nullptr : found->second.Get();
  }

  void Keep(double time, vtkDataObject* data)
  {
    vtkSmartPointer<vtkDataObject>& kept = this->Kept[time];
    const vtkSmartPointer<vtkDataObject> taken = vtkSPHTakeVertices(data, vtkSPHHaveVertices(data));
    kept.TakeReference(taken->NewInstance());
    kept->ShallowCopy(taken);
  }

  /** Returns the time of the first step that is needed and not kept, or nullptr. */
  const double* FirstLacking() const
  {
    const auto lacking = std::find_if(
      this->Times.begin(), this->Times.end(), [this](double time) { return !this->Find(time); });
    return lacking == this->Times.end() ? nullptr : &*lacking;
  }

  double Time = 0.0;                                     // requested time
  std::vector<double> Times = { 0.0 };                   // of the steps that Time needs: 1 or 2
  std::map<double, vtkSmartPointer<vtkDataObject>> Kept; // steps that were read, by time
  std::map<size_t, vtkSPHTemporalPair> Pairs;            // by block
  std::set<long> Ratios;                                 // MotionRatio of past warnings, rounded
  vtkTimeStamp ToldTime;                                 // when Ratios was last emptied
};

namespace
{
/** Times that differ by at most this share of the interval between two steps count as the same: 3 * 0.1 counts as 0.3. */
const double SameTime = 1e-9;

std::vector<double> TimesOf(vtkInformation* info)
{
  const double* times = info->Get(Pipeline::TIME_STEPS());
  return times ? std::vector<double>(times, times + info->Length(Pipeline::TIME_STEPS()))
               : std::vector<double>();
}

/**
 * Returns the stored time that equals the requested time; the first or last stored time if the
 * requested time is outside the range; else the two stored times around it.
 */
std::vector<double> StepsAround(const std::vector<double>& times, double time)
{
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after == times.begin() || after == times.end())
  {
    return { after == times.end() ? times.back() : times.front() };
  }
  const double begin = *(after - 1), end = *after, tolerance = SameTime * (end - begin);
  if (end - time <= tolerance || time - begin <= tolerance)
  {
    return { end - time <= tolerance ? end : begin };
  }
  return { begin, end };
}
}

vtkStandardNewMacro(vtkSPHTemporalInterpolator);

vtkSPHTemporalInterpolator::vtkSPHTemporalInterpolator()
  : Internals(new vtkInternals)
{
}

vtkSPHTemporalInterpolator::~vtkSPHTemporalInterpolator() = default;

int vtkSPHTemporalInterpolator::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  return 1;
}

int vtkSPHTemporalInterpolator::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject");
  return 1;
}

void vtkSPHTemporalInterpolator::Fail(const std::string& message)
{
  const std::string sentence = this->BlockName + message;
  this->ErrorMessage += (this->ErrorMessage.empty() ? "" : "\n") + sentence;
  vtkErrorMacro(<< sentence);
}

// Makes a vtkPolyData as output, or a tree of blocks if the input has blocks.
vtkTypeBool vtkSPHTemporalInterpolator::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!request->Has(Pipeline::REQUEST_DATA_OBJECT()))
  {
    return this->Superclass::ProcessRequest(request, inputVector, outputVector);
  }
  auto* blocks = vtkDataObjectTree::GetData(inputVector[0]);
  vtkDataObject* old = vtkDataObject::GetData(outputVector);
  if (!old || !old->IsA(blocks ? blocks->GetClassName() : "vtkPolyData"))
  {
    auto made = vtkSmartPointer<vtkDataObject>::Take(
      blocks ? static_cast<vtkDataObject*>(blocks->NewInstance()) : vtkPolyData::New());
    outputVector->GetInformationObject(0)->Set(vtkDataObject::DATA_OBJECT(), made);
  }
  return 1;
}

int vtkSPHTemporalInterpolator::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  this->Internals->Kept.clear(); // something changed upstream
  vtkInformation* output = outputVector->GetInformationObject(0);
  const std::vector<double> stored = TimesOf(inputVector[0]->GetInformationObject(0));
  if (stored.empty())
  {
    return 1; // one set of particles, which is passed on
  }
  std::vector<double> offered;
  for (size_t i = 0; i + 1 < stored.size(); ++i)
  {
    for (int k = 0; k < this->ResampleFactor; ++k)
    {
      offered.push_back(stored[i] + (stored[i + 1] - stored[i]) * k / this->ResampleFactor);
    }
  }
  offered.push_back(stored.back());
  const double range[2] = { stored.front(), stored.back() };
  output->Set(Pipeline::TIME_STEPS(), offered.data(), static_cast<int>(offered.size()));
  output->Set(Pipeline::TIME_RANGE(), range, 2);
  return 1;
}

// Requests the first step that is needed and not kept. If all are kept, requests no new step.
int vtkSPHTemporalInterpolator::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation *input = inputVector[0]->GetInformationObject(0),
                 *output = outputVector->GetInformationObject(0);
  const std::vector<double> stored = TimesOf(input);
  vtkInternals& steps = *this->Internals;
  steps.Time = output->Has(Pipeline::UPDATE_TIME_STEP()) ? output->Get(Pipeline::UPDATE_TIME_STEP())
    : stored.empty()                                     ? 0.0
                                                         : stored.front();
  if (stored.empty())
  {
    steps.Kept.clear(); // particles without a time are taken as they are now
    steps.Times = { steps.Time };
    return 1;
  }
  steps.Times = StepsAround(stored, steps.Time);
  if (const double* lacking = steps.FirstLacking())
  {
    input->Set(Pipeline::UPDATE_TIME_STEP(), *lacking);
  }
  else
  {
    input->Remove(Pipeline::UPDATE_TIME_STEP());
  }
  return 1;
}

// CONTINUE_EXECUTING is not used: with it VTK's pipeline loops for ever if the second step cannot
// be read.
bool vtkSPHTemporalInterpolator::FetchSteps(vtkInformation* input)
{
  vtkInternals& steps = *this->Internals;
  if (const double* asked = steps.FirstLacking())
  {
    steps.Keep(*asked, vtkDataObject::GetData(input));
  }
  for (auto step = steps.Kept.begin(); step != steps.Kept.end();)
  {
    const bool isUsed =
      std::find(steps.Times.begin(), steps.Times.end(), step->first) != steps.Times.end();
    step = isUsed ? std::next(step) : steps.Kept.erase(step);
  }
  if (const double* lacking = steps.FirstLacking())
  {
    vtkAlgorithmOutput* from = this->GetInputConnection(0, 0);
    vtkNew<vtkInformation> wanted;
    wanted->CopyEntry(input, Pipeline::UPDATE_PIECE_NUMBER());
    wanted->CopyEntry(input, Pipeline::UPDATE_NUMBER_OF_PIECES());
    wanted->CopyEntry(input, Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS());
    wanted->Set(Pipeline::UPDATE_TIME_STEP(), *lacking);
    vtkNew<vtkInformationVector> ports;
    ports->SetInformationObject(from->GetIndex(), wanted);
    if (!from->GetProducer()->Update(from->GetIndex(), ports))
    {
      std::ostringstream sentence;
      sentence << "The step at time " << *lacking << " could not be read.";
      this->Fail(sentence.str());
      return false;
    }
    steps.Keep(*lacking, from->GetProducer()->GetOutputDataObject(from->GetIndex()));
  }
  return true;
}

int vtkSPHTemporalInterpolator::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* input = inputVector[0]->GetInformationObject(0);
  this->ErrorMessage.clear();
  this->BlockName.clear();
  this->UsedIdArrayName.clear();
  this->UsedVelocityArrayName.clear();
  vtkInternals& steps = *this->Internals;
  if (!(this->TimeScale > 0.0 && std::isfinite(this->TimeScale)))
  {
    this->Fail("The time scale must be greater than 0.");
    return 1;
  }
  if (!this->FetchSteps(input))
  {
    return 1;
  }
  vtkDataObject* first = steps.Find(steps.Times.front());
  vtkDataObject* second = steps.Find(steps.Times.back());
  vtkDataObject* to = vtkDataObject::GetData(outputVector);
  if (auto* blocks = vtkDataObjectTree::SafeDownCast(to))
  {
    this->FillBlocks(
      vtkDataObjectTree::SafeDownCast(first), vtkDataObjectTree::SafeDownCast(second), blocks);
  }
  else
  {
    this->Fill(0, first, second, vtkPolyData::SafeDownCast(to));
  }
  if (input->Has(Pipeline::TIME_STEPS()))
  {
    to->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), steps.Time);
  }
  return 1; // also after an error, see vtkSPHAlgorithm::RequestData
}

void vtkSPHTemporalInterpolator::FillBlocks(
  vtkDataObjectTree* first, vtkDataObjectTree* second, vtkDataObjectTree* output)
{
  if (!first || !second)
  {
    this->Fail("Only one of two steps has blocks.");
    return;
  }
  output->CopyStructure(first);
  const std::vector<std::string> names = vtkSPHNameBlocks(first);
  const auto iterator = vtk::TakeSmartPointer(first->NewTreeIterator());
  iterator->InitTraversal();
  for (size_t i = 0; i < names.size(); ++i, iterator->GoToNextItem())
  {
    this->BlockName = names[i] + ": ";
    vtkNew<vtkPolyData> particles;
    this->Fill(i, iterator->GetCurrentDataObject(), second->GetDataSet(iterator), particles);
    output->SetDataSetFrom(iterator, particles);
  }
  this->BlockName.clear();
}

void vtkSPHTemporalInterpolator::Fill(
  size_t block, vtkDataObject* first, vtkDataObject* second, vtkPolyData* output)
{
  vtkPointSet* sets[2] = { vtkPointSet::SafeDownCast(first), vtkPointSet::SafeDownCast(second) };
  if (!output || !sets[0] || !sets[1])
  {
    this->Fail("Not all steps hold points.");
    return;
  }
  const std::vector<double>& times = this->Internals->Times;
  if (times.size() < 2)
  {
    vtkSPHTemporalCopy(sets[0], output);
    return;
  }
  vtkSPHTemporalPair& pair = this->Internals->Pairs[block];
  const double extent[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 }; // only lengths count
  std::vector<double> found;
  if (this->DetectPeriod)
  {
    found = vtkSPHBoundsOfPeriod(vtkSPHFindPeriod(sets[0]->GetFieldData()).Period, extent);
  }
  const double* p = found.empty() ? this->PeriodicBounds : found.data();
  const vtkSPHTemporalChoice choice = { this->IdArrayName, this->VelocityArrayName,
    this->UseVelocities != 0, this->TimeScale, { times[0], times[1] },
    { p[1] - p[0], p[3] - p[2], p[5] - p[4] } };
  const bool matched = pair.Match(sets[0], sets[1], choice);
  this->UsedIdArrayName = pair.IdName;
  this->UsedVelocityArrayName = pair.VelocityName;
  this->MotionRatio = pair.Ratio;
  if (!matched)
  {
    this->Fail(pair.Error);
    return;
  }
  vtkInternals& told = *this->Internals;
  if (told.ToldTime < this->GetMTime())
  {
    told.Ratios.clear();
    told.ToldTime.Modified();
  }
  for (const std::string& warning : pair.Warnings)
  {
    // Warns once for all intervals in which the times are wrong by about the same factor.
    if (pair.Ratio == 0.0 ||
      told.Ratios.insert(std::lround(4.0 * std::log2(std::max(pair.Ratio, 0.01)))).second)
    {
      vtkWarningMacro(<< this->BlockName << warning);
    }
  }
  pair.Interpolate(this->Internals->Time, output);
}

void vtkSPHTemporalInterpolator::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(IdArrayName, VelocityArrayName, UseVelocities, PeriodicBounds, DetectPeriod,
    UsedIdArrayName, UsedVelocityArrayName, MotionRatio, TimeScale, ResampleFactor, ErrorMessage);
}
VTK_ABI_NAMESPACE_END
