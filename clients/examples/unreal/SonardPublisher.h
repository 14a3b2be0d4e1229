// SPDX-License-Identifier: Apache-2.0
// A component for the vehicle's actor that sends its pose to sonard in each tick. Copy it and SonardPose.h
// into the Source folder of your module, and add "Sockets" and "Networking" to its
// PublicDependencyModuleNames. No test compiles this file, because it needs the engine. Tests compile
// SonardPose.h, which has all conversions.
#pragma once

#include "Components/ActorComponent.h"
#include "Components/PrimitiveComponent.h"
#include "CoreMinimal.h"
#include "Engine/World.h"
#include "GameFramework/Actor.h"
#include "IPAddress.h"
#include "SocketSubsystem.h"
#include "Sockets.h"
#include "SonardPose.h"

#include "SonardPublisher.generated.h"

UCLASS(meta = (BlueprintSpawnableComponent))
class USonardPublisher : public UActorComponent {
  GENERATED_BODY()

 public:
  UPROPERTY(EditAnywhere) FString Host = TEXT("127.0.0.1");
  UPROPERTY(EditAnywhere) int32 Port = 14600;

  USonardPublisher() {
    PrimaryComponentTick.bCanEverTick = true;
    PrimaryComponentTick.TickGroup = TG_PostPhysics;
  }

  virtual void BeginPlay() override {
    Super::BeginPlay();
    ISocketSubsystem* Sockets = ISocketSubsystem::Get(PLATFORM_SOCKETSUBSYSTEM);
    bool bValid = false;
    Receiver = Sockets->CreateInternetAddr();
    Receiver->SetIp(*Host, bValid);
    Receiver->SetPort(Port);
    Socket = bValid ? Sockets->CreateSocket(NAME_DGram, TEXT("sonard"), false) : nullptr;
  }

  virtual void EndPlay(const EEndPlayReason::Type Reason) override {
    if (Socket) {
      Socket->Close();
      ISocketSubsystem::Get(PLATFORM_SOCKETSUBSYSTEM)->DestroySocket(Socket);
      Socket = nullptr;
    }
    Super::EndPlay(Reason);
  }

  virtual void TickComponent(float Delta, ELevelTick Type, FActorComponentTickFunction* Function) override {
    Super::TickComponent(Delta, Type, Function);
    const AActor* Vehicle = GetOwner();
    const FVector Location = Vehicle->GetActorLocation();
    const FQuat Rotation = Vehicle->GetActorQuat();
    FVector Velocity = Vehicle->GetVelocity();
    FVector TurnRate = FVector::ZeroVector;
    UPrimitiveComponent* Root = Cast<UPrimitiveComponent>(Vehicle->GetRootComponent());
    if (Root && Root->IsSimulatingPhysics()) {
      Velocity = Root->GetPhysicsLinearVelocityAtPoint(Location);
      TurnRate = Root->GetPhysicsAngularVelocityInRadians();
    }
    const std::string Message = sonard_unreal::EncodeUpdate(
        GetWorld()->GetTimeSeconds(), sonard_unreal::Position(Location), sonard_unreal::Orientation(Rotation),
        sonard_unreal::Velocity(Rotation.UnrotateVector(Velocity)),
        sonard_unreal::TurnRate(Rotation.UnrotateVector(TurnRate)));
    if (Socket) {
      int32 Sent = 0;
      Socket->SendTo(reinterpret_cast<const uint8*>(Message.data()), static_cast<int32>(Message.size()), Sent,
                     *Receiver);
    }
  }

 private:
  FSocket* Socket = nullptr;
  TSharedPtr<FInternetAddr> Receiver;
};
