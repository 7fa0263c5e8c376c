// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Composite data: blocks that are one set of particles; and each block by itself, in its place, where messages
// name the block, and none is lost.
#include "TestParticles.h"

#include "vtkCommand.h"
#include "vtkCompositeDataSet.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkOverlappingAMR.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkSPHDerivatives.h"
#include "vtkTable.h"

namespace
{
int failures = 0;

vtkSmartPointer<vtkPolyData> MakeBroken()
{
  auto cube = test::MakeCube();
  cube->GetPointData()->GetArray("SmoothingLength")->SetComponent(17, 0, -1.0);
  return cube;
}

vtkSmartPointer<vtkPolyData> ExtractAlone()
{
  auto filter = test::MakeSphereFilter(test::MakeCube());
  filter->Update();
  CHECK(filter->GetOutput()->GetNumberOfCells() > 0);
  return filter->GetOutput();
}

/// Each block by itself.
vtkSmartPointer<vtkMarchingCorrectors> MakeApart(vtkDataObject* input)
{
  auto filter = test::MakeSphereFilter(input);
  filter->SetBlocksToApart();
  return filter;
}

bool Has(const std::string& text, const char* part)
{
  return text.find(part) != std::string::npos;
}

// Broken, good, an image, empty, none, broken without a name within a block, good.
void TestMessages()
{
  const auto expected = ExtractAlone();
  vtkNew<vtkMultiBlockDataSet> blocks, within;
  auto named = test::MakeCube();
  vtkNew<vtkDoubleArray> time;
  time->SetName("TimeValue");
  time->InsertNextValue(0.5);
  named->GetFieldData()->AddArray(time);
  blocks->SetBlock(0, MakeBroken());
  blocks->GetMetaData(0u)->Set(vtkCompositeDataSet::NAME(), "first");
  blocks->SetBlock(1, named);
  blocks->SetBlock(2, vtkNew<vtkImageData>());
  blocks->GetMetaData(2u)->Set(vtkCompositeDataSet::NAME(), "picture");
  blocks->SetBlock(3, vtkNew<vtkPolyData>());
  blocks->SetBlock(4, nullptr);
  within->SetBlock(0, MakeBroken());
  blocks->SetBlock(5, within);
  blocks->SetBlock(6, test::MakeCube());

  auto filter = MakeApart(blocks);
  int errors = 0, warnings = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  test::CountEvents(filter, vtkCommand::WarningEvent, &warnings);
  filter->Update();
  const std::string message = filter->GetErrorMessage();
  std::cout << message << "\n";
  CHECK(errors == 2 && warnings == 1);
  CHECK(message.find("Block 'first', index 1: The smoothing length") == 0);
  CHECK(Has(message, "\nBlock index 7: The smoothing length"));
  CHECK(Has(message, "particle 17"));

  auto* output = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
  CHECK(output && output->GetNumberOfBlocks() == 7);
  const auto surface = [output](unsigned int i)
  { return vtkPolyData::SafeDownCast(output->GetBlock(i)); };
  CHECK(!std::strcmp(output->GetMetaData(0u)->Get(vtkCompositeDataSet::NAME()), "first"));
  for (const unsigned int i : { 0u, 2u, 3u })
  {
    CHECK(surface(i) && surface(i)->GetNumberOfPoints() == 0);
  }
  CHECK(surface(1) && test::SameSurface(expected, surface(1)));
  CHECK(surface(1)->GetFieldData()->HasArray("TimeValue"));
  CHECK(surface(1)->GetFieldData()->HasArray("IsoValues"));
  CHECK(!output->GetBlock(4));
  CHECK(surface(6) && test::SameSurface(expected, surface(6)));

  // Good data again, and other kinds of output: nothing of the errors stays.
  blocks->SetBlock(0, test::MakeCube());
  blocks->SetBlock(5, nullptr);
  filter->Update();
  CHECK(!*filter->GetErrorMessage());
  filter->SetInputData(named);
  filter->Update();
  CHECK(filter->GetOutput() && test::SameSurface(expected, filter->GetOutput()));
}

// Partitions are called by the name of what they are parts of.
void TestPartitions()
{
  vtkNew<vtkPartitionedDataSetCollection> collection;
  vtkNew<vtkPartitionedDataSet> walls, water;
  walls->SetPartition(0, test::MakeCube());
  water->SetPartition(0, test::MakeCube());
  water->SetPartition(1, MakeBroken());
  collection->SetPartitionedDataSet(0, walls);
  collection->SetPartitionedDataSet(1, water);
  collection->GetMetaData(1u)->Set(vtkCompositeDataSet::NAME(), "water");
  auto filter = MakeApart(collection);
  filter->Update();
  std::cout << filter->GetErrorMessage() << "\n";
  CHECK(Has(filter->GetErrorMessage(), "Block 'water', index 5: "));
  auto* output = vtkPartitionedDataSetCollection::SafeDownCast(filter->GetOutputDataObject(0));
  CHECK(output && output->GetNumberOfPartitionedDataSets() == 2);
  const auto surface = [output](unsigned int set, unsigned int part)
  { return vtkPolyData::SafeDownCast(output->GetPartitionedDataSet(set)->GetPartition(part)); };
  CHECK(surface(0, 0) && test::SameSurface(ExtractAlone(), surface(0, 0)));
  CHECK(surface(1, 0) && test::SameSurface(ExtractAlone(), surface(1, 0)));
  CHECK(!surface(1, 1) || surface(1, 1)->GetNumberOfPoints() == 0);

  filter->SetInputDataObject(water);
  filter->Update();
  auto* parts = vtkPartitionedDataSet::SafeDownCast(filter->GetOutputDataObject(0));
  CHECK(parts && parts->GetPartition(0));
  CHECK(test::SameSurface(ExtractAlone(), vtkPolyData::SafeDownCast(parts->GetPartition(0))));
}

// The cost is that of all blocks; the fraction of the progress never falls.
void TestSums()
{
  auto filter = MakeApart(test::MakeCube());
  filter->KeepDeviceDataOff();
  filter->Update();
  const auto cost = [&filter](const char* name)
  { return filter->GetRunStatistics()->GetArray(name)->GetComponent(0, 0); };
  const double bricks = cost("Bricks"), bytes = cost("DeviceBytesPeak");
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, test::MakeCube());
  blocks->SetBlock(1, test::MakeCube());
  filter->SetInputDataObject(blocks);
  double last = 0.0;
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback(
    [](vtkObject* caller, unsigned long, void* data, void*)
    {
      double& before = *static_cast<double*>(data);
      const double now = static_cast<vtkAlgorithm*>(caller)->GetProgress();
      CHECK(now >= before && now <= 1.0);
      before = now;
    });
  observer->SetClientData(&last);
  filter->AddObserver(vtkCommand::ProgressEvent, observer);
  filter->Update();
  CHECK(last > 0.9);
  CHECK(cost("Bricks") == 2.0 * bricks && cost("DeviceBytesPeak") == bytes);
  CHECK(filter->GetProgressScale() == 1.0 && filter->GetProgressShift() == 0.0);
}

// Aborted in its second block: no surface of the first one alone.
void TestAbort()
{
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, test::MakeCube());
  blocks->SetBlock(1, test::MakeCube());
  auto filter = MakeApart(blocks);
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*)
    {
      auto* algorithm = static_cast<vtkAlgorithm*>(caller);
      algorithm->SetAbortExecute(algorithm->GetProgress() > 0.6);
    });
  filter->AddObserver(vtkCommand::ProgressEvent, observer);
  filter->Update();
  auto* output = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
  CHECK(output && output->GetNumberOfPoints() == 0);
  CHECK(!*filter->GetErrorMessage());
}

// Blocks of cells without points of their own: refused, not crashed on.
void TestNoPointSets()
{
  vtkNew<vtkOverlappingAMR> amr;
  const int blocksPerLevel[] = { 1 };
  amr->Initialize(1, blocksPerLevel);
  auto filter = test::MakeSphereFilter(amr);
  int errors = 0;
  test::CountEvents(filter, vtkCommand::ErrorEvent, &errors);
  filter->Update();
  filter->SetInputDataObject(vtkNew<vtkTable>());
  filter->Update();
  CHECK(errors > 0);
  vtkNew<vtkMultiBlockDataSet> none;
  filter->SetInputDataObject(none);
  filter->Update();
  CHECK(filter->GetOutput() && filter->GetOutput()->GetNumberOfPoints() == 0);
  CHECK(!*filter->GetErrorMessage());
  filter->SetBlocksToApart();
  filter->Update();
  CHECK(vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0)));
  CHECK(!*filter->GetErrorMessage());
}

/// Takes the particles for which `isIn` is true, with all arrays.
vtkSmartPointer<vtkPolyData> Take(vtkPolyData* from, const std::function<bool(vtkIdType)>& isIn)
{
  auto taken = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(from->GetPoints()->GetDataType());
  taken->GetPointData()->CopyAllocate(from->GetPointData());
  for (vtkIdType i = 0; i < from->GetNumberOfPoints(); ++i)
  {
    if (isIn(i))
    {
      const vtkIdType to = points->InsertNextPoint(from->GetPoint(i));
      taken->GetPointData()->CopyData(from->GetPointData(), i, to);
    }
  }
  taken->SetPoints(points);
  return taken;
}

// Particles in two blocks, in any order, and one more empty block: the surface of one set, to the last bit.
// An array that one block lacks is left out. What is put together is kept while the blocks are the same.
void TestTogether()
{
  auto cube = test::MakeCube();
  auto whole = test::MakeSphereFilter(cube);
  whole->Update();
  const auto left = [&](vtkIdType i) { return cube->GetPoint(i)[0] < 0.05; };
  auto second = Take(cube, left);
  auto first = Take(cube, [&](vtkIdType i) { return !left(i); });
  test::AddArray<vtkDoubleArray>(first, "Own", 1, [](vtkIdType, int) { return 1.0; });
  vtkNew<vtkMultiBlockDataSet> blocks, within;
  within->SetBlock(0, second);
  blocks->SetBlock(0, first);
  blocks->SetBlock(1, within);
  blocks->SetBlock(2, vtkNew<vtkPolyData>());
  blocks->SetBlock(3, vtkNew<vtkImageData>());
  vtkNew<vtkDoubleArray> time;
  time->SetName("TimeValue");
  time->InsertNextValue(0.5);
  second->GetFieldData()->AddArray(time);
  auto filter = test::MakeSphereFilter(blocks);
  int warnings = 0;
  test::CountEvents(filter, vtkCommand::WarningEvent, &warnings);
  filter->Update();
  CHECK(warnings == 0 && !*filter->GetErrorMessage());
  CHECK(filter->GetOutput() && test::SameSurface(whole->GetOutput(), filter->GetOutput()));
  CHECK(filter->GetOutput()->GetFieldData()->HasArray("TimeValue"));
  CHECK(test::SameStatistics(whole->GetRunStatistics(), filter->GetRunStatistics()));

  const double before = filter->GetRunStatistics()->GetArray("MarchRounds")->GetComponent(0, 0);
  filter->SetValue(0, 0.7);
  filter->Update();
  whole->SetValue(0, 0.7);
  whole->Update();
  CHECK(before > 0.0 && test::SameSurface(whole->GetOutput(), filter->GetOutput()));
  vtkDataArray* radius = second->GetPointData()->GetArray("Radius");
  for (vtkIdType i = 0; i < radius->GetNumberOfTuples(); ++i)
  {
    radius->SetComponent(i, 0, 2.0 * radius->GetComponent(i, 0));
  }
  radius->Modified();
  filter->Modified();
  filter->Update();
  CHECK(!test::SameSurface(whole->GetOutput(), filter->GetOutput()));

  filter->SetBlocksToApart();
  filter->Update();
  CHECK(vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0)));
}

// Walls in a block of their own, as its name says, without the scalar: solid, where that is asked for.
void TestWalls()
{
  auto cube = test::MakeCube();
  const auto isWall = [&](vtkIdType i) { return cube->GetPoint(i)[2] < -0.45; };
  auto walls = Take(cube, isWall);
  walls->GetPointData()->RemoveArray("Radius");
  walls->GetPointData()->RemoveArray("Volume");
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, walls);
  blocks->SetBlock(1, Take(cube, [&](vtkIdType i) { return !isWall(i); }));
  blocks->GetMetaData(0u)->Set(vtkCompositeDataSet::NAME(), "Boundary");
  blocks->GetMetaData(1u)->Set(vtkCompositeDataSet::NAME(), "Fluid");
  auto filter = test::MakeSphereFilter(blocks);
  int warnings = 0;
  test::CountEvents(filter, vtkCommand::WarningEvent, &warnings);
  filter->Update();
  CHECK(warnings == 1 && !*filter->GetUsedFluid());
  const vtkIdType all = filter->GetOutput()->GetNumberOfCells();
  filter->DetectFluidOn();
  CHECK(!std::strcmp(filter->GetNextFluid(), "WallBlock = 0"));
  filter->Update();
  CHECK(warnings == 1 && !std::strcmp(filter->GetUsedFluid(), "WallBlock = 0"));
  CHECK(!filter->GetOutput()->GetPointData()->HasArray("WallBlock"));

  // As one set in which an array tells.
  test::AddArray<vtkIntArray>(cube, "Kind", 1, [&](vtkIdType i, int) { return isWall(i) ? 7 : 4; });
  auto one = test::MakeSphereFilter(cube);
  one->SetFluidArrayName("Kind");
  one->SetFluidValue(4.0);
  one->AddExcludedArray("Kind");
  one->Update();
  CHECK(test::SameSurface(one->GetOutput(), filter->GetOutput()));
  CHECK(filter->GetOutput()->GetNumberOfCells() > 100);
  CHECK(filter->GetOutput()->GetNumberOfCells() != all);

  filter->SetBlocksToApart();
  filter->Update();
  CHECK(warnings >= 2); // walls that are not seen
}

// Derivatives stay in their blocks, and see the others.
void TestDerivatives()
{
  auto cube = test::MakeCube();
  const auto left = [&](vtkIdType i) { return cube->GetPoint(i)[0] < 0.05; };
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, Take(cube, left));
  blocks->SetBlock(2, Take(cube, [&](vtkIdType i) { return !left(i); }));
  vtkNew<vtkSPHDerivatives> derivatives, whole;
  derivatives->SetInputDataObject(blocks);
  whole->SetInputDataObject(cube);
  for (vtkSPHDerivatives* each : { derivatives.Get(), whole.Get() })
  {
    each->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Radius");
    each->Update();
  }
  auto* output = vtkMultiBlockDataSet::SafeDownCast(derivatives->GetOutput());
  auto* expected = vtkPolyData::SafeDownCast(whole->GetOutput());
  CHECK(output && output->GetNumberOfBlocks() == 3 && !output->GetBlock(1));
  for (const unsigned int b : { 0u, 2u })
  {
    auto* block = vtkPolyData::SafeDownCast(output->GetBlock(b));
    const auto part = Take(expected, [&](vtkIdType i) { return left(i) == (b == 0); });
    CHECK(block &&
      test::SameValues(
        part->GetPointData()->GetArray("Gradients"), block->GetPointData()->GetArray("Gradients")));
    CHECK(block->GetPointData()->HasArray("Radius"));
  }
}
}

int TestBlocks(int, char*[])
{
  TestMessages();
  TestPartitions();
  TestSums();
  TestAbort();
  TestNoPointSets();
  TestTogether();
  TestWalls();
  TestDerivatives();
  return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
