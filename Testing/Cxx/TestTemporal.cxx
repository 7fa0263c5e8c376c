// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Particles between stored steps: cubic motion exactly, whatever their order, and those of one step alone.
#include "TestParticles.h"

#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyDataAlgorithm.h"
#include "vtkSPHTemporalInterpolator.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <array>
#include <map>
#include <vector>

namespace
{
int failures = 0;

const std::vector<double> StoredTimes = { 0.5, 1.25, 3.0 };
const int Count = 60;

/// Particles 0 to Count - 1 are in all steps, Count in the first one alone, Count + 1 in the others.
bool IsIn(int id, double time)
{
  return id < Count || (id == Count) == (time < 1.0);
}

/// Coefficients of a particle's path, a cubic in time.
double Coefficient(int id, int axis, int power)
{
  return std::sin(1.7 * id + 2.3 * axis + 0.9 * power + 1.0) / (1 + power);
}

double Position(int id, int axis, double t)
{
  const auto c = [=](int power) { return Coefficient(id, axis, power); };
  return c(0) + t * (c(1) + t * (c(2) + t * c(3)));
}

double Velocity(int id, int axis, double t)
{
  const auto c = [=](int power) { return Coefficient(id, axis, power); };
  return c(1) + t * (2.0 * c(2) + t * 3.0 * c(3));
}

/// Linear in time.
double Value(int id, double t)
{
  return 3.0 * id + 7.0 * t;
}

/// Makes the particles of a stored step, in an order of its own.
class StepSource : public vtkPolyDataAlgorithm
{
public:
  static StepSource* New();
  vtkTypeMacro(StepSource, vtkPolyDataAlgorithm);
  const char* IdName = "Idp";
  bool HasVelocity = true;
  int Made = 0;

protected:
  StepSource() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    using Pipeline = vtkStreamingDemandDrivenPipeline;
    vtkInformation* info = output->GetInformationObject(0);
    const double range[2] = { StoredTimes.front(), StoredTimes.back() };
    info->Set(Pipeline::TIME_STEPS(), StoredTimes.data(), static_cast<int>(StoredTimes.size()));
    info->Set(Pipeline::TIME_RANGE(), range, 2);
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    const double time =
      output->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
    std::vector<int> ids;
    for (int i = 0; i < Count + 2; ++i)
    {
      const int id = (i * 7 + static_cast<int>(11.0 * time)) % (Count + 2); // 62 and 7 are coprime
      if (IsIn(id, time))
      {
        ids.push_back(id);
      }
    }
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (int id : ids)
    {
      points->InsertNextPoint(Position(id, 0, time), Position(id, 1, time), Position(id, 2, time));
    }
    auto* data = vtkPolyData::GetData(output);
    data->SetPoints(points);
    test::AddArray<vtkIdTypeArray>(data, this->IdName, 1, [&](vtkIdType i, int) { return ids[i]; });
    test::AddArray<vtkDoubleArray>(
      data, "Value", 1, [&](vtkIdType i, int) { return Value(ids[i], time); });
    if (this->HasVelocity)
    {
      test::AddArray<vtkDoubleArray>(
        data, "Velocity", 3, [&](vtkIdType i, int axis) { return Velocity(ids[i], axis, time); });
    }
    data->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    ++this->Made;
    return 1;
  }
};
vtkStandardNewMacro(StepSource);

/// The particles at a time, by number: place in the output.
std::map<int, vtkIdType> PlacesAt(
  vtkSPHTemporalInterpolator* filter, double time, const char* idName)
{
  std::map<int, vtkIdType> places;
  filter->UpdateTimeStep(time);
  vtkPolyData* output = filter->GetOutput();
  vtkDataArray* ids = output ? output->GetPointData()->GetArray(idName) : nullptr;
  for (vtkIdType i = 0; ids && i < output->GetNumberOfPoints(); ++i)
  {
    places[static_cast<int>(ids->GetComponent(i, 0))] = i;
  }
  CHECK(ids && static_cast<vtkIdType>(places.size()) == output->GetNumberOfPoints());
  return places;
}

/// Largest distance of the particles of all steps from where their paths are.
double FarthestOff(vtkSPHTemporalInterpolator* filter, double time, const char* idName)
{
  const auto places = PlacesAt(filter, time, idName);
  vtkPolyData* output = filter->GetOutput();
  vtkDataArray* value = output->GetPointData()->GetArray("Value");
  double farthest = 0.0;
  CHECK(value);
  for (int id = 0; value && id < Count; ++id)
  {
    const auto at = places.find(id);
    CHECK(at != places.end());
    if (at == places.end())
    {
      continue;
    }
    double x[3];
    output->GetPoint(at->second, x);
    for (int axis = 0; axis < 3; ++axis)
    {
      farthest = std::max(farthest, std::abs(x[axis] - Position(id, axis, time)));
    }
    CHECK(std::abs(value->GetComponent(at->second, 0) - Value(id, time)) < 1e-12 * (1 + 3.0 * id));
  }
  return farthest;
}

void CheckCubicMotion(const char* idName)
{
  vtkNew<StepSource> source;
  source->IdName = idName;
  vtkNew<vtkSPHTemporalInterpolator> filter;
  filter->SetInputConnection(source->GetOutputPort());
  for (double time : { 0.5, 0.6, 0.875, 1.2, 1.25, 1.3, 2.0, 2.99, 3.0 })
  {
    CHECK(FarthestOff(filter, time, idName) < 1e-12 * 30.0);
  }
  CHECK(source->Made == 3);
  CHECK(FarthestOff(filter, 2.0, idName) < 1e-12 * 30.0); // back
  CHECK(std::string(filter->GetUsedIdArrayName()) == idName);
  CHECK(std::string(filter->GetUsedVelocityArrayName()) == "Velocity");
  // Without velocities positions are linear, which these paths are not.
  filter->UseVelocitiesOff();
  CHECK(FarthestOff(filter, 2.0, idName) > 0.1);
  CHECK(FarthestOff(filter, 3.0, idName) == 0.0);
}

/// One step alone: they belong to the half next to it, and move there with their velocity.
void CheckParticlesOfOneStep()
{
  vtkNew<StepSource> source;
  vtkNew<vtkSPHTemporalInterpolator> filter;
  filter->SetInputConnection(source->GetOutputPort());
  struct Case
  {
    double Time;
    int Present, Absent;
    double From; // the step that the present one is in
  };
  for (const Case& c : { Case{ 0.8, Count, Count + 1, 0.5 }, Case{ 0.95, Count + 1, Count, 1.25 } })
  {
    const auto places = PlacesAt(filter, c.Time, "Idp");
    CHECK(places.size() == Count + 1 && places.count(c.Present) == 1 && !places.count(c.Absent));
    if (places.count(c.Present) != 1)
    {
      continue;
    }
    const vtkIdType at = places.at(c.Present);
    double x[3];
    filter->GetOutput()->GetPoint(at, x);
    for (int axis = 0; axis < 3; ++axis)
    {
      const double expected =
        Position(c.Present, axis, c.From) + (c.Time - c.From) * Velocity(c.Present, axis, c.From);
      CHECK(std::abs(x[axis] - expected) < 1e-12 * 30.0);
    }
    vtkDataArray* value = filter->GetOutput()->GetPointData()->GetArray("Value");
    CHECK(value && value->GetComponent(at, 0) == Value(c.Present, c.From));
  }
}

/// The later step's order from the middle on, the earlier one's before.
void CheckOrder()
{
  vtkNew<StepSource> source;
  vtkNew<vtkSPHTemporalInterpolator> filter;
  filter->SetInputConnection(source->GetOutputPort());
  const auto numbers = [&](double time)
  {
    std::vector<int> list;
    filter->UpdateTimeStep(time);
    vtkDataArray* ids = filter->GetOutput()->GetPointData()->GetArray("Idp");
    for (vtkIdType i = 0; i < ids->GetNumberOfTuples(); ++i)
    {
      list.push_back(static_cast<int>(ids->GetComponent(i, 0)));
    }
    return list;
  };
  const auto early = numbers(1.25), late = numbers(3.0);
  CHECK(early != late);
  CHECK(numbers(2.0) == early && numbers(2.2) == late);
}

void CheckNoNumbers()
{
  vtkNew<StepSource> source;
  source->IdName = "Color";
  vtkNew<vtkSPHTemporalInterpolator> filter;
  filter->SetInputConnection(source->GetOutputPort());
  int errors = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  filter->UpdateTimeStep(0.7);
  CHECK(errors > 0 && filter->GetErrorMessage() && *filter->GetErrorMessage());
  for (double time : { 0.5, 1.25 + 1e-12 }) // a stored step needs none, but for rounding
  {
    filter->UpdateTimeStep(time);
    CHECK(filter->GetOutput()->GetNumberOfPoints() == Count + 1);
  }
}
}

int TestTemporal(int, char*[])
{
  CheckCubicMotion("Idp");
  CheckCubicMotion("iorig");
  CheckParticlesOfOneStep();
  CheckOrder();
  CheckNoNumbers();
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
